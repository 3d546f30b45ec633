/* Free play: after a reversal the valve stands still until the rod has gone delta. */
typedef play backlash_held_past;

static motion backlash_held(const backlash_held_parameters *p, const motion *m,
                            const backlash_held_past *past, backlash_held_past *next)
{
    stretch_of_travel step = travelled(p->delta, 0.0, 1.0, m, past, next);
    return held_still(p->delta, m, &step);
}
