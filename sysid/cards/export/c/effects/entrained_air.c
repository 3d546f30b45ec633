/* Air on one side of the piston: after the reversal into that direction the fluid stands still
 * until the rod has gone delta_a. */
typedef play entrained_air_past;

static motion entrained_air(const entrained_air_parameters *p, const motion *m,
                            const entrained_air_past *past, entrained_air_past *next)
{
    stretch_of_travel step = travelled(p->delta_a, 0.0, 1.0, m, past, next);
    if (!(p->side * step.moved > 0.0))
        step.before = p->delta_a;
    return held_still(p->delta_a, m, &step);
}
