/* A bristle that bends before it slides, y from -1 to 1:
 *     dy/dx = (sgn v - y) / reach,   exact on every step. */
typedef struct {
    double x, y;
} bristle;

static double bent(double reach, const motion *m, const bristle *past, bristle *next)
{
    double moved = m->first ? 0.0 : m->x - past->x;
    double part = fabs(moved) / fmax(reach, 1.0e-12);
    next->x = m->x;
    next->y = m->first ? 0.0 : exp(-part) * past->y - expm1(-part) * sign(moved);
    return next->y;
}
