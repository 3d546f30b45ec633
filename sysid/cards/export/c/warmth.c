/* Kelvins above 40 degC, at which laws of temperature change nothing; 0 where T is not known. */
static double excess_temperature(const motion *m) { return isnan(m->T) ? 0.0 : m->T - 40.0; }
