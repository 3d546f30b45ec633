/* A signal as it was some time ago, straight between samples; before the first its first value. */
enum { DELAY_SAMPLES = 4096 };

typedef struct {
    double time[DELAY_SAMPLES], value[DELAY_SAMPLES];
    int newest, count, place;
    int too_short; /* the delay has reached beyond what is kept */
} delay_line;

static double delayed(double delay, double value, const motion *m, delay_line *line)
{
    double when = m->t - delay, share;
    int k, older;
    if (m->first)
        line->count = 0;
    line->newest = (line->count == 0) ? 0 : (line->newest + 1) % DELAY_SAMPLES;
    if (line->count < DELAY_SAMPLES)
        line->count++;
    line->time[line->newest] = m->t;
    line->value[line->newest] = value;
    line->too_short = 0;
    k = line->newest;
    for (older = 1; older < line->count; older++) {
        int before = (k + DELAY_SAMPLES - 1) % DELAY_SAMPLES;
        if (line->time[k] <= when)
            break;
        if (line->time[before] <= when) {
            share = (when - line->time[before]) / (line->time[k] - line->time[before]);
            return line->value[before] + share * (line->value[k] - line->value[before]);
        }
        k = before;
    }
    line->too_short = when < line->time[k] && line->count == DELAY_SAMPLES;
    return line->value[k];
}
