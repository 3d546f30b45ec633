/* F_rec = F / (1 + sqrt(2) s tau_c + s^2 tau_c^2), by its two complex poles: the real part of
 * (1 - j) times the signal behind one pole with the constant (1 + j) tau_c / sqrt(2). */
typedef struct {
    double in, real, imaginary;
} force_filter_two_past;

static double force_filter_two(const force_filter_two_parameters *p, double force, const motion *m,
                               const force_filter_two_past *past, force_filter_two_past *next)
{
    double size, decay, kept_r, kept_i, held_r, held_i;
    next->in = force;
    if (m->first || !(p->tau_c > 0.0)) {
        next->real = force;
        next->imaginary = 0.0;
        return force;
    }
    size = p->tau_c / m->h / sqrt(2.0);      /* ratio = (1 + j) size */
    decay = exp(-0.5 / size);                /* kept = exp(-1 / ratio) */
    kept_r = decay * cos(0.5 / size);
    kept_i = decay * sin(0.5 / size);
    held_r = size * (1.0 - kept_r + kept_i); /* held = ratio (1 - kept) */
    held_i = size * (1.0 - kept_r - kept_i);
    next->real = kept_r * past->real - kept_i * past->imaginary + (1.0 - held_r) * force +
                 (held_r - kept_r) * past->in;
    next->imaginary = kept_r * past->imaginary + kept_i * past->real - held_i * force +
                      (held_i - kept_i) * past->in;
    return next->real + next->imaginary;
}
