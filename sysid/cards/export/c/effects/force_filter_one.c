/* F_rec = F / (1 + s tau_c). */
typedef lag force_filter_one_past;

static double force_filter_one(const force_filter_one_parameters *p, double force, const motion *m,
                               const force_filter_one_past *past, force_filter_one_past *next)
{
    return lagged(p->tau_c, force, m, past, next);
}
