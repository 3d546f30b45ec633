/* F_rec = d_F round(F / d_F). */
static double force_quantization(const force_quantization_parameters *p, double force,
                                 const motion *m)
{
    (void)m;
    return p->d_F > 0.0 ? p->d_F * rint(force / p->d_F) : force;
}
