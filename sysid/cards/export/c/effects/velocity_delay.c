/* The valve sees a velocity that is tau_v late, and goes through the places that belong to it. */
typedef struct {
    delay_line velocity, place;
    double late;
} velocity_delay_line;

static motion velocity_delay(const velocity_delay_parameters *p, const motion *m,
                             velocity_delay_line *line)
{
    motion moved = *m;
    double late = delayed(p->tau_v, m->x, m, &line->place) - m->x;
    moved.v = delayed(p->tau_v, m->v, m, &line->velocity);
    moved.stride += m->first ? 0.0 : late - line->late;
    line->late = late;
    return moved;
}
