/* The middle of the stroke is x_0 from where the record has it; v_m^2 <- max(v_m^2 - a x_0, 0). */
static motion displacement_zero(const displacement_zero_parameters *p, const motion *m)
{
    motion moved = *m;
    moved.x += p->x_0;
    moved.v_m = sqrt(fmax(m->v_m * m->v_m - m->a * p->x_0, 0.0));
    return moved;
}
