/* s(i) = (1 - e^{-q |i|}) / q: the current as far as the field makes use of it. */
static double effective_current(double current, double q)
{
    double i = fabs(current);
    if (fabs(q * i) < 1.0e-6)
        return i * (1.0 - 0.5 * q * i);
    return -expm1(-q * i) / q;
}
