/* i_eff = tanh(q_s i) / q_s: amplifier or core limit the current to 1 / q_s. */
static double current_saturation(const current_saturation_parameters *p, const motion *m)
{
    double z = p->q_s * m->i;
    return m->i * (fabs(z) < 1.0e-4 ? 1.0 - z * z / 3.0 : tanh(z) / z);
}
