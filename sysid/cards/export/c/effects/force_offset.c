/* F_rec = F + F_off. */
static double force_offset(const force_offset_parameters *p, double force, const motion *m)
{
    (void)m;
    return force + p->F_off;
}
