// Functions of <cmath> that the headers of the package use. They are those of the C library: no C++ standard library is needed.
// Included in a namespace.
inline double atan(double x) { return __builtin_atan(x); }
inline float atan(float x) { return __builtin_atanf(x); }
inline double cos(double x) { return __builtin_cos(x); }
inline float cos(float x) { return __builtin_cosf(x); }
inline double exp(double x) { return __builtin_exp(x); }
inline float exp(float x) { return __builtin_expf(x); }
inline double fabs(double x) { return __builtin_fabs(x); }
inline float fabs(float x) { return __builtin_fabsf(x); }
inline double log(double x) { return __builtin_log(x); }
inline float log(float x) { return __builtin_logf(x); }
inline double rint(double x) { return __builtin_rint(x); }
inline float rint(float x) { return __builtin_rintf(x); }
inline double sin(double x) { return __builtin_sin(x); }
inline float sin(float x) { return __builtin_sinf(x); }
inline double sqrt(double x) { return __builtin_sqrt(x); }
inline float sqrt(float x) { return __builtin_sqrtf(x); }
