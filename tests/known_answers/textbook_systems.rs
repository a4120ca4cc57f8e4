//! Small systems of textbooks and applications: how many solutions, and how many with multiplicities.
//!
//! Multiple points of the literature on them, critical points, chemistry, geometry, power flow, iterated maps. The
//! numbers are dimensions of quotient rings, by the ideal and by its radical, that Singular computed modulo 32003
//! and 31991.

use crate::check::solve;
use cognate_algorithms::{SolveMethod, SolveOptions};
use cognate_tests::systems::written;

/// Name, system, distinct solutions, solutions with their multiplicities.
const SYSTEMS: &[(&str, &str, u64, u64)] = &[
    (
        "circles that touch three circles",
        "variable_group x,y,r; function f1,f2,f3; f1 = (x-0)^2+(y-0)^2-(r+1)^2; f2 = \
         (x-5)^2+(y-1)^2-(r-2)^2; f3 = (x-2)^2+(y-6)^2-(r+3)^2;",
        2,
        2,
    ),
    (
        "... three that touch each other in a row",
        "variable_group x,y,r; function f1,f2,f3; f1 = x^2+y^2-(r+1)^2; f2 = (x-3)^2+y^2-(r+2)^2; f3 \
         = (x-6)^2+y^2-(r+1)^2;",
        2,
        2,
    ),
    (
        "numbers of very different size",
        "variable_group x,y; function f1,f2; f1 = 100000000000000000000*x*y-1; f2 = x-y-1/100000;",
        2,
        2,
    ),
    (
        "bilinear shared",
        "variable_group a,b,x,y; function f1,f2,f3,f4; f1 = a*x+b*y-1; f2 = a*y-b*x-2; f3 = \
         a*x-3*b+y; f4 = a+b*y-x;",
        6,
        6,
    ),
    (
        "three binomials",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^3*y-2*z; f2 = y^2*z-3*x; f3 = z^2*x-5*y;",
        20,
        20,
    ),
    (
        "CBMS 1 (Sturmfels)",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^3-y*z; f2 = y^3-x*z; f3 = z^3-x*y;",
        17,
        27,
    ),
    (
        "CBMS 2",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^3-3*x^2*y+3*x*y^2-y^3-z^2; f2 = \
         z^3-3*z^2*x+3*z*x^2-x^3-y^2; f3 = y^3-3*y^2*z+3*y*z^2-z^3-x^2;",
        7,
        14,
    ),
    (
        "Chandrasekhar's equation, 4 unknowns",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = 8*a-a*(4/7)*(1/2*a+1/3*b+1/4*c+1/5*d)-8; \
         f2 = 8*b-b*(4/7)*(2/3*a+2/4*b+2/5*c+2/6*d)-8; f3 = 8*c-c*(4/7)*(3/4*a+3/5*b+3/6*c+3/7*d)-8; \
         f4 = 8*d-d*(4/7)*(4/5*a+4/6*b+4/7*c+4/8*d)-8;",
        16,
        16,
    ),
    (
        "Chebyshev polynomials of degree 8",
        "variable_group x,y; function f1,f2; f1 = 128*x^8-256*x^6+160*x^4-32*x^2+1-y; f2 = \
         128*y^8-256*y^6+160*y^4-32*y^2+1-x;",
        64,
        64,
    ),
    (
        "a weak acid",
        "variable_group h,o,a,ha,n; function f1,f2,f3,f4,f5; f1 = h*o-1/100000000000000; f2 = \
         h*a-18/1000000*ha; f3 = a+ha-1/10; f4 = h+n-o-a; f5 = n-5/100;",
        3,
        3,
    ),
    (
        "Michaelis and Menten, steady",
        "variable_group s,e,c,p; function f1,f2,f3,f4; f1 = -1000000*s*e+100*c; f2 = e+c-1/1000000; \
         f3 = s+c+p-1/100; f4 = 10*c-1/10000*p;",
        2,
        2,
    ),
    (
        "phosphorylation",
        "variable_group a,b,c,d,e,f; function f1,f2,f3,f4,f5,f6; f1 = a+c+d-10; f2 = b+e+f-2; f3 = \
         1000*a*b-3*c; f4 = 20*c-7*d*e; f5 = d*e*50-f/100; f6 = a*f-b*d/1000;",
        5,
        5,
    ),
    (
        "a genetic toggle switch",
        "variable_group x,y; function f1,f2; f1 = 1/1000*x*(1+y^2)-5*(1+1/1000*y^2); f2 = \
         1/1000*y*(1+x^3)-7*(1+1/100*x);",
        7,
        7,
    ),
    (
        "A5",
        "variable_group x,y; function f1,f2; f1 = x^5; f2 = y;",
        1,
        5,
    ),
    (
        "E8",
        "variable_group x,y; function f1,f2; f1 = 3*x^2; f2 = 5*y^4;",
        1,
        8,
    ),
    (
        "J10",
        "variable_group x,y; function f1,f2; f1 = 3*x^2+y^4+2*x*y^2; f2 = 4*x*y^3+2*x^2*y+6*y^5;",
        1,
        10,
    ),
    (
        "X9",
        "variable_group x,y; function f1,f2; f1 = 4*x^3+2*x*y^2; f2 = 4*y^3+2*x^2*y;",
        1,
        9,
    ),
    (
        "crit beale",
        "variable_group x,y; function f1,f2; f1 = \
         2*(3/2-x+x*y)*(y-1)+2*(9/4-x+x*y^2)*(y^2-1)+2*(21/8-x+x*y^3)*(y^3-1); f2 = \
         2*(3/2-x+x*y)*x+4*(9/4-x+x*y^2)*x*y+6*(21/8-x+x*y^3)*x*y^2;",
        7,
        7,
    ),
    (
        "crit goldstein",
        "variable_group x,y; function f1,f2; f1 = 4*x^3+2*x*y^2-6*x; f2 = 2*x^2*y+6*y^5-y;",
        15,
        15,
    ),
    (
        "crit himmelblau",
        "variable_group x,y; function f1,f2; f1 = 4*x*(x^2+y-11)+2*(x+y^2-7); f2 = \
         2*(x^2+y-11)+4*y*(x+y^2-7);",
        9,
        9,
    ),
    (
        "crit robinson",
        "variable_group x,y; function f1,f2; f1 = 6*x^5-4*x^3-4*x^3*y^2-2*x*y^4-2*x+6*x*y^2; f2 = \
         6*y^5-4*y^3-4*y^3*x^2-2*y*x^4-2*y+6*y*x^2;",
        21,
        21,
    ),
    (
        "dec 5bar",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = a^2+b^2-1; f2 = c^2+d^2-1; f3 = \
         0.5*a*c+0.3*b*d-0.25*a+0.1; f4 = 0.7*a*d-0.2*b*c+0.4*c-0.35;",
        8,
        8,
    ),
    (
        "decimals circle",
        "variable_group x,y; function f1,f2; f1 = x^2+y^2-1.0; f2 = x+y-1.41421356;",
        2,
        2,
    ),
    (
        "decimals conics",
        "variable_group x,y; function f1,f2; f1 = 0.333333*x^2+0.25*x*y-1.1*y^2+0.7*x-2.1; f2 = \
         1.7*x^2-0.9*x*y+0.77*y^2-1.3*y-0.6;",
        4,
        4,
    ),
    (
        "decimals near double",
        "variable_group x,y; function f1,f2; f1 = x^2-2.0001*x+1.0001; f2 = y^2-x;",
        4,
        4,
    ),
    (
        "Decker, Keller, Kelley 2",
        "variable_group x,y; function f1,f2; f1 = x+y^3; f2 = x^2*y-y^4;",
        4,
        7,
    ),
    (
        "det rank1",
        "variable_group x,y,z,w; function f1,f2,f3,f4; f1 = x*w-y*z; f2 = x*(z+1)-(y+2)*w; f3 = \
         x+2*y+3*z-4; f4 = w-x+y^2;",
        7,
        7,
    ),
    (
        "ed cardioid",
        "variable_group x,y,l; function f1,f2,f3; f1 = (x^2+y^2+x)^2-x^2-y^2; f2 = \
         x-3-l*(2*(x^2+y^2+x)*(2*x+1)-2*x); f3 = y-2-l*(2*(x^2+y^2+x)*2*y-2*y);",
        3,
        3,
    ),
    (
        "ed cayley",
        "variable_group x,y,z,l; function f1,f2,f3,f4; f1 = x^2*y+x*y*z+1-3*x*z^2; f2 = \
         x-1-l*(2*x*y+y*z-3*z^2); f3 = y-2-l*(x^2+x*z); f4 = z+1-l*(x*y-6*x*z);",
        15,
        15,
    ),
    (
        "ed cusp",
        "variable_group x,y,l; function f1,f2,f3; f1 = y^2-x^3; f2 = x-2+l*3*x^2; f3 = y-1-l*2*y;",
        4,
        4,
    ),
    (
        "ed ellipse",
        "variable_group x,y,l; function f1,f2,f3; f1 = x^2+4*y^2-4; f2 = x-1/2-l*2*x; f3 = \
         y-1/3-l*8*y;",
        4,
        4,
    ),
    (
        "ed whitney",
        "variable_group x,y,z,l; function f1,f2,f3,f4; f1 = x^2-y^2*z; f2 = x-1-l*2*x; f3 = \
         y-2+l*2*y*z; f4 = z+1+l*y^2;",
        7,
        7,
    ),
    (
        "eig jordan",
        "variable_group x0,x1,x2,l; function f1,f2,f3,f4; f1 = 2*x0+x1-l*x0; f2 = 2*x1+x2-l*x1; f3 = \
         2*x2-l*x2; f4 = 3*x0+5*x1+7*x2-1;",
        1,
        3,
    ),
    (
        "four satellites",
        "variable_group x,y,z,b; function f1,f2,f3,f4; f1 = \
         (x-15600)^2+(y-7540)^2+(z-20140)^2-(21114-299792*b)^2; f2 = \
         (x-18760)^2+(y-2750)^2+(z-18610)^2-(21000-299792*b)^2; f3 = \
         (x-17610)^2+(y-14630)^2+(z-13480)^2-(23600-299792*b)^2; f4 = \
         (x-19170)^2+(y-610)^2+(z-18390)^2-(20800-299792*b)^2;",
        2,
        2,
    ),
    (
        "Griewank and Osborne",
        "variable_group x,y; function f1,f2; f1 = 29/16*x^3-2*x*y; f2 = y-x^2;",
        1,
        3,
    ),
    (
        "two trinomials of degree 6",
        "variable_group x,y; function f1,f2; f1 = x^6+(44/31)*y^3-y; f2 = y^6+(44/31)*x^3-x;",
        36,
        36,
    ),
    (
        "Henon's map, period 4",
        "variable_group x,y,z,w; function f1,f2,f3,f4; f1 = y-1+7/5*x^2-3/10*w; f2 = \
         z-1+7/5*y^2-3/10*x; f3 = w-1+7/5*z^2-3/10*y; f4 = x-1+7/5*w^2-3/10*z;",
        16,
        16,
    ),
    (
        "hidden double",
        "variable_group x,y,z; function f1,f2,f3; f1 = x*y-z; f2 = x^2+y^2-2*z; f3 = x+y+z-3;",
        2,
        4,
    ),
    (
        "Kobayashi, Suzuki, Sakai, 4 unknowns",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = a^2+a+b+c+d-2*a-3; f2 = \
         b^2+a+b+c+d-2*b-3; f3 = c^2+a+b+c+d-2*c-3; f4 = d^2+a+b+c+d-2*d-3;",
        6,
        16,
    ),
    (
        "kuramoto3",
        "variable_group s1,c1,s2,c2; function f1,f2,f3,f4; f1 = -1/10-(s1*1-c1*0)-(s1*c2-c1*s2); f2 = \
         s1^2+c1^2-1; f3 = 2/10-(s2*1-c2*0)-(s2*c1-c2*s1); f4 = s2^2+c2^2-1;",
        6,
        6,
    ),
    (
        "kuramoto4",
        "variable_group s1,c1,s2,c2,s3,c3; function f1,f2,f3,f4,f5,f6; f1 = \
         7/10-(s1*1-c1*0)-(s1*c2-c1*s2)-(s1*c3-c1*s3); f2 = s1^2+c1^2-1; f3 = \
         -9/10-(s2*1-c2*0)-(s2*c1-c2*s1)-(s2*c3-c2*s3); f4 = s2^2+c2^2-1; f5 = \
         5/10-(s3*1-c3*0)-(s3*c1-c3*s1)-(s3*c2-c3*s2); f6 = s3^2+c3^2-1;",
        14,
        14,
    ),
    (
        "kuramoto zero3",
        "variable_group s1,c1,s2,c2; function f1,f2,f3,f4; f1 = 0-(s1*1-c1*0)-(s1*c2-c1*s2); f2 = \
         s1^2+c1^2-1; f3 = 0-(s2*1-c2*0)-(s2*c1-c2*s1); f4 = s2^2+c2^2-1;",
        6,
        6,
    ),
    (
        "lagrange monkey",
        "variable_group x,y,l; function f1,f2,f3; f1 = x^2+y^2-1; f2 = 3*x^2-3*y^2-2*l*x; f3 = \
         -6*x*y-2*l*y;",
        6,
        6,
    ),
    (
        "lagrange product",
        "variable_group x,y,z,l; function f1,f2,f3,f4; f1 = x^2+y^2+z^2-3; f2 = y*z-2*l*x; f3 = \
         x*z-2*l*y; f4 = x*y-2*l*z;",
        14,
        14,
    ),
    (
        "logistic map, period 4",
        "variable_group x,y,z,w; function f1,f2,f3,f4; f1 = y-4*x*(1-x); f2 = z-4*y*(1-y); f3 = \
         w-4*z*(1-z); f4 = x-4*w*(1-w);",
        16,
        16,
    ),
    (
        "Lotka and Volterra",
        "variable_group x,y,z,w; function f1,f2,f3,f4; f1 = x*(1-x-2*y-3*z-w); f2 = \
         y*(1-y-2*z-3*w-x/2); f3 = z*(1-z-2*w-3*x-y/5); f4 = w*(1-w-2*x-3*y-z/3);",
        14,
        15,
    ),
    (
        "Leykin, Verschelde, Zhao",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^2+y^2+z^2-1; f2 = (x+y-1)^2; f3 = \
         (x-y)*(x+y-1)+z^2;",
        2,
        8,
    ),
    (
        "Mignotte's polynomial",
        "variable_group x,y; function f1,f2; f1 = x^9-2*(50*x-1)^2; f2 = y^2-x*y-1;",
        18,
        18,
    ),
    (
        "mth191",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^3+y^2+z^2-1; f2 = x^2+y^3+z^2-1; f3 = \
         x^2+y^2+z^3-1;",
        18,
        27,
    ),
    (
        "multi at inf",
        "variable_group x,y; function f1,f2; f1 = x^3*y-1; f2 = x^2*y^2-x*y+2;",
        4,
        4,
    ),
    (
        "nash3 1",
        "variable_group p,q,s; function f1,f2,f3; f1 = (-5)*q*s+(9)*q+(-7)*s+(-1); f2 = \
         (-6)*p*s+(6)*p+(5)*s+(6); f3 = (3)*p*q+(-3)*p+(-6)*q+(6);",
        2,
        2,
    ),
    (
        "nash3 2",
        "variable_group p,q,s; function f1,f2,f3; f1 = (-8)*q*s+(-7)*q+(-7)*s+(2); f2 = \
         (-4)*p*s+(0)*p+(-1)*s+(-3); f3 = (-8)*p*q+(9)*p+(-4)*q+(4);",
        2,
        2,
    ),
    (
        "Ojika 1",
        "variable_group x,y; function f1,f2; f1 = x^2+y-3; f2 = x+1/8*y^2-3/2;",
        2,
        4,
    ),
    (
        "Ojika 2",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^2+y+z-1; f2 = x+y^2+z-1; f3 = x+y+z^2-1;",
        5,
        8,
    ),
    (
        "Ojika 3",
        "variable_group x,y,z; function f1,f2,f3; f1 = x+y+z-1; f2 = 2*x^3+5*y^2-10*z+5*z^3+5; f3 = \
         2*x+2*y+z^2-1;",
        2,
        6,
    ),
    (
        "overdetermined veronese",
        "variable_group x,y,z; function f1,f2,f3,f4,f5; f1 = x^2-y; f2 = x*y-z; f3 = x*z-y^2; f4 = \
         x^3-z; f5 = z-8;",
        3,
        3,
    ),
    (
        "three points in perspective",
        "variable_group a,b,c; function f1,f2,f3; f1 = a^2+b^2-2*a*b*7/10-3; f2 = \
         b^2+c^2-2*b*c*4/10-5; f3 = a^2+c^2-2*a*c*6/10-4;",
        8,
        8,
    ),
    (
        "... at equal distances",
        "variable_group a,b,c; function f1,f2,f3; f1 = a^2+b^2-2*a*b*1/2-1; f2 = b^2+c^2-2*b*c*1/2-1; \
         f3 = a^2+c^2-2*a*c*1/2-1;",
        8,
        8,
    ),
    (
        "pendulum",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = a^2+b^2-1; f2 = c^2+d^2-1; f3 = \
         a*c-b*d-1/3; f4 = a*d+b*c-1/2;",
        0,
        0,
    ),
    (
        "two octics",
        "variable_group x,y; function f1,f2; f1 = x^8+28*x^4+1; f2 = x^4+y^4-2*x^2*y^2-1/7;",
        32,
        32,
    ),
    (
        "power3 1",
        "variable_group x1,y1,x2,y2; function f1,f2,f3,f4; f1 = -1/10-5*(y1*1-x1*0)-3*(y1*x2-x1*y2); \
         f2 = x1^2+y1^2-1; f3 = -6/10-19*(y2*1-x2*0)-3*(y2*x1-x2*y1); f4 = x2^2+y2^2-1;",
        6,
        6,
    ),
    (
        "power4 2",
        "variable_group x1,y1,x2,y2,x3,y3; function f1,f2,f3,f4,f5,f6; f1 = \
         -1/10-2*(y1*1-x1*0)-12*(y1*x2-x1*y2)-6*(y1*x3-x1*y3); f2 = x1^2+y1^2-1; f3 = \
         -3/10-3*(y2*1-x2*0)-12*(y2*x1-x2*y1)-10*(y2*x3-x2*y3); f4 = x2^2+y2^2-1; f5 = \
         -8/10-3*(y3*1-x3*0)-6*(y3*x1-x3*y1)-10*(y3*x2-x3*y2); f6 = x3^2+y3^2-1;",
        20,
        20,
    ),
    (
        "power sums that vanish",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = a+b+c+d; f2 = a^2+b^2+c^2+d^2; f3 = \
         a^3+b^3+c^3+d^3; f4 = a^4+b^4+c^4+d^4;",
        1,
        24,
    ),
    (
        "quadeig3",
        "variable_group x0,x1,x2,l; function f1,f2,f3,f4; f1 = \
         (-5+(9)*l+(-7)*l^2)*x0+(-1+(-6)*l+(6)*l^2)*x1+(5+(6)*l+(3)*l^2)*x2; f2 = \
         (-3+(-6)*l+(6)*l^2)*x0+(-9+(3)*l+(4)*l^2)*x1+(-9+(5)*l+(-1)*l^2)*x2; f3 = \
         (-2+(9)*l+(-6)*l^2)*x0+(1+(-9)*l+(-9)*l^2)*x1+(-9+(8)*l+(-9)*l^2)*x2; f4 = \
         (7)*x0+(4)*x1+(7)*x2-1;",
        6,
        6,
    ),
    (
        "spheres4",
        "variable_group x,y,z; function f1,f2,f3,f4; f1 = x^2+y^2+z^2-1; f2 = (x-1)^2+y^2+z^2-1; f3 = \
         x^2+(y-1)^2+z^2-1; f4 = x^2+y^2+(z-1)^2-1;",
        0,
        0,
    ),
    (
        "conics",
        "variable_group a,b,c; function f1,f2,f3; f1 = b^2-4*a*c-5*(a+b)^2; f2 = (b-1)^2-4*a*(c-1); \
         f3 = (b+2*a)^2-4*a*(c+b+a);",
        1,
        2,
    ),
    (
        "three spheres tangent",
        "variable_group x,y,z; function f1,f2,f3; f1 = x^2+y^2+z^2-1; f2 = (x-2)^2+y^2+z^2-1; f3 = \
         x+y+z-1;",
        1,
        2,
    ),
    (
        "two trinomials with an origin of multiplicity 20",
        "variable_group x,y; function f1,f2; f1 = x^5-(49/95)*x^3*y+y^6; f2 = y^5-(49/95)*x*y^3+x^6;",
        17,
        36,
    ),
    (
        "two pairs of equal roots",
        "variable_group a,b,c,d; function f1,f2,f3,f4; f1 = a+b+c+d-6; f2 = \
         a*b+a*c+a*d+b*c+b*d+c*d-13; f3 = a*b*c+a*b*d+a*c*d+b*c*d-12; f4 = a*b*c*d-4;",
        6,
        24,
    ),
    (
        "roots of a quintic",
        "variable_group a,b,c,d,e; function f1,f2,f3,f4,f5; f1 = a+b+c+d+e-1; f2 = \
         a*b+a*c+a*d+a*e+b*c+b*d+b*e+c*d+c*e+d*e-2; f3 = \
         a*b*c+a*b*d+a*b*e+a*c*d+a*c*e+a*d*e+b*c*d+b*c*e+b*d*e+c*d*e-3; f4 = \
         a*b*c*d+a*b*c*e+a*b*d*e+a*c*d*e+b*c*d*e-5; f5 = a*b*c*d*e-7;",
        120,
        120,
    ),
];

#[test]
fn small_systems_of_textbooks_have_their_solutions() {
    let mut wrong = String::new();
    for (name, text, distinct, with_multiplicity) in SYSTEMS {
        let system = written(text);
        for (seed, method) in [
            (1, SolveMethod::Auto),
            (2, SolveMethod::Auto),
            (3, SolveMethod::TotalDegree),
        ] {
            let options = SolveOptions {
                seed,
                method,
                ..SolveOptions::default()
            };
            let (_, sets) = solve(&system, &options, &|_| None);
            let counts = &sets[0].counts;
            let actual_counts = (counts.distinct, counts.with_multiplicity, sets[0].settled());
            if actual_counts != (*distinct, *with_multiplicity, true) {
                wrong += &format!(
                    "{name}, seed {seed}: {actual_counts:?} instead of {distinct}, {with_multiplicity}\n"
                );
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
