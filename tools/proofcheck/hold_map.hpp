#pragma once

#include "numbers.hpp"

namespace {

// ------------------------------------------------------------- 15, the radius while torques are held
//
// Under exact linearisation the outputs of a hold are polynomials in the time but for their jerk. With
// tau = w times the time since the tick, x a unit vector and R the bound at the tick, sqrt(V) is at most
// R - shrinking - tau x' N x: inequality 1 of docs/level5.md.

// What errors add, over w^2: the jerk times half the hold, and |S e| at the tick.
struct HoldErrors { I grown, at_tick; };

// Whether N is positive definite for every tau from 0 to `last`, products being split with `split`.
bool outputs_fall(I last, I radius, HoldErrors e, I shrink, double split) {
  const double pieces = 8.0;
  const I half = I(0.5) * I(split), all = e.grown + e.at_tick;
  const I both = all / (I(2.0) * I(split)) + shrink;
  for (double k = 0.0; k < pieces; k += 1.0) {
    const I from = last * I(k / pieces), to = last * I((k + 1.0) / pieces);
    const I tau(-from.low(), to.high()), two = square(tau), three = two * tau;
    const I a = radius * (I(1.0) - I(0.625) * tau) - half * all - both;
    const I b = radius * (I(0.25) + I(0.25) * tau - I(0.625) * two) -
                half * (e.grown * (I(2.0) + I(2.0) * tau / I(3.0)) + e.at_tick * (I(2.0) + tau));
    const I c = radius * (I(1.0) - I(0.5) * two - I(0.625) * three) -
                half * (e.grown * (I(4.0) + I(8.0) * tau / I(3.0) + I(0.5) * two) +
                        e.at_tick * square(I(2.0) + tau)) - both;
    if (!(a.low() > 0.0 && (a * c - square(b)).low() > 0.0)) return false;
  }
  return true;
}

// The same for some split.
bool outputs_fall(I last, I radius, HoldErrors errors, I shrink) {
  for (const double split : {0.4, 0.45, 0.5, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5})
    if (outputs_fall(last, radius, errors, shrink, split)) return true;
  return false;
}

}  // namespace
