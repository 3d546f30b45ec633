/* sgn_s(v) = tanh(v / 0.3 mm/s): the sign of a velocity without a jump. */
static double smooth_sign(double v) { return tanh(v / 3.0e-4); }
