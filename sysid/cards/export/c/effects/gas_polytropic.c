/* F = F_g [(1 - x/x_g)^(-n_g) - 1 - n_g x/x_g]: the gas beyond its value and slope at the centre. */
static double gas_polytropic(const gas_polytropic_parameters *p, const motion *m)
{
    double z = m->x / p->x_g;
    return p->F_g * (pow(fmax(1.0 - z, 0.05), -p->n_g) - 1.0 - p->n_g * z);
}
