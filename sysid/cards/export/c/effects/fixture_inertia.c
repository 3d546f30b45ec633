/* F = m_x a: what moves with the rod on the damper's side of the load cell. */
static double fixture_inertia(const fixture_inertia_parameters *p, const motion *m)
{
    return p->m_x * m->a;
}
