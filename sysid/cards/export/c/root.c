/* The root of a function that rises at least as fast as its argument.
 *
 * First by secants from the slope at the last root, which takes three or four values where the
 * function is smooth.  Where that is slow, in the bracket between z and z - f(z) by false position,
 * the older end's value lowered where one end stays (Anderson and Bjorck), halved now and then.
 * `found` is 0 where there is no sign change; the best point is then returned.  The last value
 * taken is always that of the point returned, so what the function leaves behind belongs to it. */
typedef double (*rising)(double z, void *about);

static double bracketed(rising f, void *about, double a, double fa, double smallest, int *found)
{
    double b = a - fa, fb = f(b, about);
    int trial;
    for (trial = 0; fa * fb > 0.0 && trial < 40; trial++) {
        b += b - a;
        fb = f(b, about);
    }
    if (!(fa * fb <= 0.0)) {
        *found = 0;
        f(a, about);
        return a;
    }
    for (trial = 0; trial < 200 && fb != 0.0; trial++) {
        double width = fabs(b - a), c = b - fb * (b - a) / (fb - fa), fc;
        if (trial % 8 == 7 || !(c > fmin(a, b) && c < fmax(a, b)))
            c = 0.5 * (a + b);
        fc = f(c, about);
        if (fc * fb <= 0.0) {
            a = b;
            fa = fb;
        } else {
            double lowered = 1.0 - fc / fb;
            fa *= lowered > 0.0 ? lowered : 0.5;
        }
        b = c;
        fb = fc;
        if (fabs(fb) <= smallest || fabs(b - a) <= 1.0e-15 * fabs(b) || fabs(b - a) == width)
            break;
    }
    return b;
}

static double root_of(rising f, void *about, double start, double *slope, double smallest,
                      int *found)
{
    double a = start, fa = f(a, about), b, fb;
    int trial;
    *found = 1;
    if (fabs(fa) <= smallest)
        return a;
    b = a - fa / fmax(*slope, 1.0);
    for (trial = 0; trial < 8 && b != a; trial++) {
        double rise;
        fb = f(b, about);
        rise = (fb - fa) / (b - a);
        if (!(rise > 0.5))
            break;
        *slope = rise;
        if (fabs(fb) <= smallest)
            return b;
        if (fabs(fb) > 0.5 * fabs(fa))
            break;
        a = b;
        fa = fb;
        b = a - fa / rise;
    }
    return b == a ? b : bracketed(f, about, a, fa, smallest, found);
}
