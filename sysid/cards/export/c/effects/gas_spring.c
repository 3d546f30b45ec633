/* F = k_g x: the accumulator's stiffness at the centre of the stroke. */
static double gas_spring(const gas_spring_parameters *p, const motion *m) { return p->k_g * m->x; }
