/* F_rec = F + h_m sin(2 pi f t), f the frequency of the mains. */
static double mains_hum(const mains_hum_parameters *p, double force, const motion *m)
{
    return force + p->h_m * sin(6.283185307179586 * p->mains * m->t);
}
