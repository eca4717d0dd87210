/*
 * Elementary functions without libm, without branches: a loop over them vectorises.
 *
 * Arguments are clamped to where a result is finite; a NaN stays a NaN. Errors, measured over all
 * arguments the controller accepts: at most 2 units in the last place of max(|result|, 2^-20) for
 * sine and cosine, 3 for the others. They rest on IEEE arithmetic rounded to nearest, without
 * excess precision: -ffast-math is refused.
 */
#ifndef NG_MATH_H
#define NG_MATH_H

#include <float.h>
#include <stdint.h>

#ifdef __FAST_MATH__
#error "build without -ffast-math: ng_math.h rounds by adding and subtracting a large number"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "build for arithmetic without excess precision (-msse2 -mfpmath=sse on 32-bit x86)"
#endif

/* One source, two precisions: define NG_FLOAT for single precision. */
#ifdef NG_FLOAT
typedef float ng_real;
typedef uint32_t ng_bits;
#define NG_MANTISSA 23
#define NG_BIAS 127
#define NG_ROUNDER 12582912.0f /* 1.5 * 2^23: adding it leaves the nearest integer in the low bits */
#define NG_SQRT_HALF_BITS 0x3f3504f3u
#define NG_ROOT_BITS 0x5f3759dfu
#define NG_TANH_BOUND 10.0f
#define NG_EXP_LOW (-87.0f)
#define NG_EXP_HIGH 88.0f
#define NG_EPSILON FLT_EPSILON
/* ln 2 and pi / 2 in parts; the first have so few bits that their products are exact. */
#define NG_LN2_A 0.693359375f
#define NG_LN2_B (-2.12194440e-4f)
#define NG_HALF_PI_A 1.5703125f
#define NG_HALF_PI_B 4.83751297e-4f
#define NG_HALF_PI_C 7.54979013e-8f
#else
typedef double ng_real;
typedef uint64_t ng_bits;
#define NG_MANTISSA 52
#define NG_BIAS 1023
#define NG_ROUNDER 6755399441055744.0 /* 1.5 * 2^52 */
#define NG_SQRT_HALF_BITS 0x3fe6a09e667f3bcdu
#define NG_ROOT_BITS 0x5fe6eb50c7b537a9u
#define NG_TANH_BOUND 20.0
#define NG_EXP_LOW (-708.0)
#define NG_EXP_HIGH 709.0
#define NG_EPSILON DBL_EPSILON
#define NG_LN2_A 6.93147180369123816490e-01
#define NG_LN2_B 1.90821492927058770002e-10
#define NG_HALF_PI_A 1.57079632673412561417e+00
#define NG_HALF_PI_B 6.07710050630396597660e-11
#define NG_HALF_PI_C 2.02226624871116645580e-21
#endif

#define NG(number) ((ng_real)(number))

/* A number and its bits. */
typedef union {
    ng_real number;
    ng_bits bits;
} ng_word;

static inline ng_real ng_clamp(ng_real x, ng_real low, ng_real high)
{
    x = x < low ? low : x;
    return x > high ? high : x;
}

static inline ng_real ng_abs(ng_real x) { return x < NG(0.0) ? -x : x; }

/* 0 for NaN and infinities. */
static inline int ng_finite(ng_real x) { return x - x == NG(0.0); }

/* exp(x) - 1 = scale * part + (scale - 1) with |part| < 0.42; |x| inside the bounds of exp. */
static inline ng_real ng_expm1_parts(ng_real x, ng_real *scale)
{
    ng_word k, power;
    k.number = x * NG(1.44269504088896340736) + NG_ROUNDER;
    const ng_real turns = k.number - NG_ROUNDER;
    const ng_real r = (x - turns * NG_LN2_A) - turns * NG_LN2_B;
    power.bits = (k.bits + NG_BIAS) << NG_MANTISSA;
    *scale = power.number;
#ifdef NG_FLOAT
    ng_real p = NG(1.0 / 5040.0);
#else
    ng_real p = NG(1.0 / 87178291200.0);
    p = p * r + NG(1.0 / 6227020800.0);
    p = p * r + NG(1.0 / 479001600.0);
    p = p * r + NG(1.0 / 39916800.0);
    p = p * r + NG(1.0 / 3628800.0);
    p = p * r + NG(1.0 / 362880.0);
    p = p * r + NG(1.0 / 40320.0);
    p = p * r + NG(1.0 / 5040.0);
#endif
    p = p * r + NG(1.0 / 720.0);
    p = p * r + NG(1.0 / 120.0);
    p = p * r + NG(1.0 / 24.0);
    p = p * r + NG(1.0 / 6.0);
    p = p * r + NG(0.5);
    return r + r * r * p;
}

static inline ng_real ng_exp(ng_real x)
{
    ng_real scale;
    const ng_real part = ng_expm1_parts(ng_clamp(x, NG_EXP_LOW, NG_EXP_HIGH), &scale);
    return scale * part + scale;
}

static inline ng_real ng_tanh(ng_real x)
{
    ng_real scale;
    const ng_real twice = NG(2.0) * ng_clamp(x, -NG_TANH_BOUND, NG_TANH_BOUND);
    const ng_real part = ng_expm1_parts(twice, &scale);
    const ng_real grown = scale * part + (scale - NG(1.0));
    return grown / (grown + NG(2.0));
}

/* 1 / (1 + exp(-x)) */
static inline ng_real ng_logistic(ng_real x)
{
    const ng_real grown = ng_exp(x);
    return grown / (NG(1.0) + grown);
}

/* log(1 + x) for x > -1 */
static inline ng_real ng_log1p(ng_real x)
{
    ng_word w, m;
    const ng_bits one = (ng_bits)NG_BIAS << NG_MANTISSA;
    w.number = NG(1.0) + x;
    const ng_bits shifted = (w.bits + (one - NG_SQRT_HALF_BITS)) >> NG_MANTISSA;
    m.bits = w.bits - (shifted << NG_MANTISSA) + one;
    const ng_real doublings = (ng_real)(int)shifted - NG(NG_BIAS);
    const ng_real lost = (x - (w.number - NG(1.0))) / w.number;
    const ng_real f = m.number - NG(1.0);
    const ng_real s = f / (NG(2.0) + f);
    const ng_real q = s * s;
#ifdef NG_FLOAT
    ng_real p = NG(1.0 / 9.0);
#else
    ng_real p = NG(1.0 / 21.0);
    p = p * q + NG(1.0 / 19.0);
    p = p * q + NG(1.0 / 17.0);
    p = p * q + NG(1.0 / 15.0);
    p = p * q + NG(1.0 / 13.0);
    p = p * q + NG(1.0 / 11.0);
    p = p * q + NG(1.0 / 9.0);
#endif
    p = p * q + NG(1.0 / 7.0);
    p = p * q + NG(1.0 / 5.0);
    p = p * q + NG(1.0 / 3.0);
    const ng_real fine = NG(2.0) * s * q * p + (lost + doublings * NG_LN2_B);
    return doublings * NG_LN2_A + (NG(2.0) * s + fine);
}

/* Sine of x + quarter * pi / 2, |x| up to some hundred turns. */
static inline ng_real ng_sine_from(ng_real x, ng_bits quarter)
{
    ng_word k;
    k.number = x * NG(0.63661977236758134308) + NG_ROUNDER;
    const ng_real turns = k.number - NG_ROUNDER;
    ng_real r = x - turns * NG_HALF_PI_A;
    r = r - turns * NG_HALF_PI_B;
    r = r - turns * NG_HALF_PI_C;
    const ng_bits quadrant = k.bits + quarter;
    const ng_real q = r * r;
#ifdef NG_FLOAT
    ng_real s = NG(1.0 / 362880.0);
    ng_real c = NG(-1.0 / 3628800.0);
#else
    ng_real s = NG(1.0 / 355687428096000.0);
    s = s * q - NG(1.0 / 1307674368000.0);
    s = s * q + NG(1.0 / 6227020800.0);
    s = s * q - NG(1.0 / 39916800.0);
    s = s * q + NG(1.0 / 362880.0);
    ng_real c = NG(-1.0 / 6402373705728000.0);
    c = c * q + NG(1.0 / 20922789888000.0);
    c = c * q - NG(1.0 / 87178291200.0);
    c = c * q + NG(1.0 / 479001600.0);
    c = c * q - NG(1.0 / 3628800.0);
#endif
    s = s * q - NG(1.0 / 5040.0);
    s = s * q + NG(1.0 / 120.0);
    s = s * q - NG(1.0 / 6.0);
    s = r + r * q * s;
    c = c * q + NG(1.0 / 40320.0);
    c = c * q - NG(1.0 / 720.0);
    c = c * q + NG(1.0 / 24.0);
    c = c * q - NG(0.5);
    c = NG(1.0) + q * c;
    const ng_real value = (quadrant & 1u) != 0u ? c : s;
    return (quadrant & 2u) != 0u ? -value : value;
}

static inline ng_real ng_sin(ng_real x) { return ng_sine_from(x, 0u); }

static inline ng_real ng_cos(ng_real x) { return ng_sine_from(x, 1u); }

/* NaN for x < 0; x above the least normal number, or 0. */
static inline ng_real ng_sqrt(ng_real x)
{
    ng_word guess;
    guess.number = x;
    guess.bits = NG_ROOT_BITS - (guess.bits >> 1);
    /* 1 / sqrt(x) within 4 %; each of Newton's iterations squares that. */
    ng_real y = guess.number;
    const ng_real half = NG(0.5) * x;
    y = y * (NG(1.5) - half * y * y);
    y = y * (NG(1.5) - half * y * y);
    y = y * (NG(1.5) - half * y * y);
#ifndef NG_FLOAT
    y = y * (NG(1.5) - half * y * y);
#endif
    const ng_real root = x * y;
    const ng_real close = root + NG(0.5) * y * (x - root * root);
    return x < NG(0.0) ? (x - x) / (x - x) : close;
}

#endif
