/* A signal behind one pole at -1/tau, exact where it is straight between samples; from rest at
 * its first value. */
typedef struct {
    double in, out;
} lag;

static double lagged(double tau, double in, const motion *m, const lag *past, lag *next)
{
    double ratio, kept, held;
    next->in = in;
    if (m->first) {
        next->out = in;
        return next->out;
    }
    ratio = tau / m->h;
    kept = ratio > 0.0 ? exp(-1.0 / ratio) : 0.0;
    held = ratio * (1.0 - kept);
    next->out = kept * past->out + (1.0 - held) * in + (held - kept) * past->in;
    return next->out;
}
