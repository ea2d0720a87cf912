# SPDX-License-Identifier: GPL-3.0-or-later
# The same in two dimensions: 6u, against 9u.
@rnd = float<ieee_64, ne>;
p0 = rnd(P0); p1 = rnd(P1); q0 = rnd(Q0); q1 = rnd(Q1);
d rnd= p0 * q1 - p1 * q0;
D = P0 * Q1 - P1 * Q0;
{ |p0| <= 1 /\ |p1| <= 1 /\ |q0| <= 1 /\ |q1| <= 1 -> |d - D| <= 6145b-63 } # 6.001u
