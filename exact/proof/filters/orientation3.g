# SPDX-License-Identifier: GPL-3.0-or-later
# The determinant of orientation() in three dimensions, its computed differences scaled to at most 1: 33u, against the
# 49u that the filter takes.
@rnd = float<ieee_64, ne>;
p0 = rnd(P0); p1 = rnd(P1); p2 = rnd(P2);
q0 = rnd(Q0); q1 = rnd(Q1); q2 = rnd(Q2);
r0 = rnd(R0); r1 = rnd(R1); r2 = rnd(R2);
d rnd= (p0 * (q1 * r2 - q2 * r1) - q0 * (p1 * r2 - p2 * r1)) + r0 * (p1 * q2 - p2 * q1);
D = (P0 * (Q1 * R2 - Q2 * R1) - Q0 * (P1 * R2 - P2 * R1)) + R0 * (P1 * Q2 - P2 * Q1);
{ |p0| <= 1 /\ |p1| <= 1 /\ |p2| <= 1 /\ |q0| <= 1 /\ |q1| <= 1 /\ |q2| <= 1 /\ |r0| <= 1 /\ |r1| <= 1 /\ |r2| <= 1
  -> |d - D| <= 2113b-59 } # 33.02u, u = 2^-53; 49u would be 3136b-59
