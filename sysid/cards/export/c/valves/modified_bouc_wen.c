/* Bouc-Wen, a dashpot and a spring, in series with a second dashpot:
 *
 *     F = F' + k_1 x + f_0,   F' = alpha w + c_0 u' + k_0 u = c_1 (v - u'),
 *     dw/du as in the Bouc-Wen model,
 *     alpha, c_0 and c_1 = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q */
typedef struct {
    series_past series;
} modified_bouc_wen_past;

static parts modified_bouc_wen_parts(const modified_bouc_wen_parameters *p, const motion *m,
                                     const changes *c, const modified_bouc_wen_past *past,
                                     modified_bouc_wen_past *next)
{
    double s = effective_current(m->i, p->q);
    series_law l;
    l.yielding[0] = p->alpha_a * c->viscous;
    l.yielding[1] = p->alpha_b * s * c->yielding;
    l.inner[0] = p->c_0a * c->viscous;
    l.inner[1] = p->c_0b * s * c->yielding;
    l.mobility = 1.0 / (p->c_1a * c->viscous + p->c_1b * s * c->yielding) + c->leakage;
    l.stiffness = p->k_0;
    l.rho = p->rho * c->stiffness;
    l.sigma = p->sigma;
    l.beside = p->k_1;
    l.constant = p->f_0;
    l.compliance = c->compliance;
    return series_parts(&l, m, &past->series, &next->series);
}
