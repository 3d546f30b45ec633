/* F_rec = (1 + g_c) F. */
static double load_cell_gain(const load_cell_gain_parameters *p, double force, const motion *m)
{
    (void)m;
    return force * (1.0 + p->g_c);
}
