/* Motion of the piston at one sample, and what happened since the last one. */
typedef struct {
    int first;     /* there was no sample before */
    double t, h;   /* s; h since the last sample, 0 at the first */
    double x;      /* m, from the centre of the motion, compression positive */
    double v, a;   /* m/s, m/s2 */
    double side;   /* sgn a, which tells the two branches of the loop apart */
    double v_m;    /* m/s, peak velocity */
    double i;      /* A */
    double T;      /* degC; NAN where it is not known */
    double stride; /* m, travel of the valve since the last sample */
} motion;

/* The two parts of a valve's force, N. */
typedef struct {
    double yielding; /* what the field makes */
    double viscous;  /* the rest */
} parts;

/* What laws change in a valve. */
typedef struct {
    double yielding, viscous; /* factors on the parts */
    double stiffness;         /* factor on the stiffness of a valve that has one */
    double side_yielding;     /* factors on `side`, which make the loop wider or narrower */
    double side_viscous;
    double leakage;    /* m/(s N), of all leaks beside the valve */
    double compliance; /* m/N, of a spring before a valve that takes it */
} changes;

static const changes NO_CHANGES = {1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0};

static double sign(double z) { return (double)((z > 0.0) - (z < 0.0)); }

static double clip(double z, double low, double high)
{
    return z < low ? low : z > high ? high : z;
}
