/* F = m_f a: the fluid that the piston accelerates through the gap. */
static double fluid_inertia(const fluid_inertia_parameters *p, const motion *m)
{
    return p->m_f * m->a;
}
