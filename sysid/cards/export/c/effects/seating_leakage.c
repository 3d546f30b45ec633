/* A leak of k F until the rod has gone delta_s since a reversal: k = k_s (1 - (T / delta_s)^n_s). */
typedef play seating_leakage_past;

/* Integral over travel of (T / gap)^n, 1 beyond the gap. */
static double seated(double gap, double n, double travel)
{
    double within = fmin(travel, gap), share = fmax(within / gap, 1.0e-9);
    return within * pow(share, n) / (1.0 + n) + (travel - within);
}

static double seating_leakage(const seating_leakage_parameters *p, const motion *m,
                              const seating_leakage_past *past, seating_leakage_past *next)
{
    double gap = fmax(p->delta_s, 1.0e-12), size, open = 0.0;
    stretch_of_travel step = travelled(gap, 0.0, 1.0, m, past, next);
    size = fabs(step.moved);
    if (size > 0.0)
        open = 1.0 - (seated(gap, p->n_s, step.before + size) - seated(gap, p->n_s, step.before)) /
                         size;
    return p->k_s * open;
}
