/* F_rec(t) = F(t - tau_F). */
typedef delay_line force_delay_line;

static double force_delay(const force_delay_parameters *p, double force, const motion *m,
                          force_delay_line *line)
{
    return delayed(p->tau_F, force, m, line);
}
