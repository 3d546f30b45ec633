/* Exact flow of dw/dx = rho (1 - sigma sgn(dx) |w| w - (1 - sigma) w^2) over a run in x. */
static double bouc_wen_flow(double rho, double sigma, double w, double run)
{
    double kappa = sqrt(fmax(2.0 * sigma - 1.0, 1.0e-12));
    double ahead = run >= 0.0 ? 1.0 : -1.0;
    double y = ahead * w;
    double angle = atan(kappa * fmin(y, 0.0)) + kappa * rho * fabs(run);
    double rise;
    if (angle < 0.0)
        return ahead * tan(angle) / kappa;
    rise = tanh(angle / kappa);
    y = fmax(y, 0.0);
    return ahead * (y + rise) / (1.0 + y * rise);
}
