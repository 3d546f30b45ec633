/* Travel since the last reversal, as a play operator sees it. */
typedef struct {
    double x, offset;
    int begun; /* it has moved */
} play;

/* The step that ends at this sample. */
typedef struct {
    double moved;      /* m, change of displacement, signed */
    double begin, end; /* which part of it counts as travel, as shares */
    double before;     /* m, travel in the direction of the step when it starts */
} stretch_of_travel;

static stretch_of_travel travelled(double reach, double begin, double end, const motion *m,
                                   const play *past, play *next)
{
    stretch_of_travel step = {m->first ? 0.0 : m->x - past->x, begin, end, 0.0};
    double half = 0.5 * reach;
    int begun = !m->first && past->begun;
    /* used up in the direction of the first step that moves */
    double offset = begun ? past->offset : half * sign(step.moved);
    double change = step.moved * (end - begin);
    step.before = half + sign(change) * offset;
    next->x = m->x;
    next->offset = clip(offset + change, -half, half);
    next->begun = begun || step.moved != 0.0;
    return step;
}

/* Integral over travel of g = 0 up to a gap, 1 beyond it. */
static double engaged_beyond(double gap, double travel) { return fmax(travel - gap, 0.0); }

/* Mean of g over the step; 1 where nothing moves. */
static double mean_engaged(double gap, const stretch_of_travel *step)
{
    double size = fabs(step->moved);
    double gained;
    if (size == 0.0)
        return 1.0;
    gained = engaged_beyond(gap, step->before + size * (step->end - step->begin)) -
             engaged_beyond(gap, step->before);
    return 1.0 - ((step->end - step->begin) - gained / size);
}

/* The valve goes along in part only: with the share g of its speed, and by what is left of the step. */
static motion held_still(double gap, const motion *m, const stretch_of_travel *step)
{
    motion held = *m;
    double g = mean_engaged(gap, step), size = fabs(step->moved);
    double gone = engaged_beyond(gap, step->before + size) - engaged_beyond(gap, step->before);
    held.v *= g;
    held.stride += sign(step->moved) * gone - step->moved;
    return held;
}
