/* tau_i di_eff/dt = i - i_eff: lag of coil and eddy currents. */
typedef lag coil_lag_past;

static double coil_lag(const coil_lag_parameters *p, const motion *m, const coil_lag_past *past,
                       coil_lag_past *next)
{
    return lagged(p->tau_i, m->i, m, past, next);
}
