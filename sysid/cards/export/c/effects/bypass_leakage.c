/* A leak of k_l F beside the valve. */
static double bypass_leakage(const bypass_leakage_parameters *p, const motion *m)
{
    (void)m;
    return p->k_l;
}
