/* The root of a function that rises at least as fast as its argument.
 *
 * With e = f(z) it lies between z and z - e.  False position in that bracket, the older end's
 * value lowered where one end stays (Anderson and Bjorck), halved where that is slow.
 * `found` is 0 where there is no sign change; the best point is then returned. */
typedef double (*rising)(double z, void *about);

static double root_of(rising f, void *about, double start, double smallest, int *found)
{
    double a = start, fa = f(a, about), b = a - fa, fb, width;
    int trial;
    *found = 1;
    if (fabs(fa) <= smallest)
        return a;
    fb = f(b, about);
    for (trial = 0; fa * fb > 0.0 && trial < 40; trial++) {
        b += b - a;
        fb = f(b, about);
    }
    if (!(fa * fb <= 0.0)) {
        *found = 0;
        return a;
    }
    for (trial = 0; trial < 200 && fb != 0.0; trial++) {
        double c, fc;
        width = fabs(b - a);
        c = b - fb * (b - a) / (fb - fa);
        if (trial % 8 == 7 || !(c > fmin(a, b) && c < fmax(a, b)))
            c = 0.5 * (a + b);
        fc = f(c, about);
        if (fc * fb <= 0.0) {
            a = b;
            fa = fb;
        } else {
            double m = 1.0 - fc / fb;
            fa *= m > 0.0 ? m : 0.5;
        }
        b = c;
        fb = fc;
        if (fabs(fb) <= smallest || fabs(b - a) <= 1.0e-15 * fabs(b) || fabs(b - a) == width)
            break;
    }
    return b;
}
