//! Student's t distribution.

/// The chance of a t below `t`, with `freedom` degrees of freedom.
///
/// By the regularised incomplete beta function: P(T < −|t|) = I_x(ν/2, ½) / 2 with x = ν / (ν + t²).
pub fn student_cdf(t: f64, freedom: f64) -> f64 {
    let tail = if t.is_infinite() {
        0.0
    } else {
        let square = t * t;
        // With its complement, which the difference from 1 would lose for small t.
        0.5 * incomplete_beta(freedom / 2.0, 0.5, freedom / (freedom + square), square / (freedom + square))
    };
    if t > 0.0 { 1.0 - tail } else { tail }
}

/// The t that lies above the given part, between ½ and 1, of the distribution.
pub fn student_quantile(part: f64, freedom: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while student_cdf(high, freedom) < part && high < f64::MAX / 4.0 {
        high *= 2.0;
    }
    // Each half gains a bit, and a number has 53.
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if student_cdf(middle, freedom) < part {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// I_x(a, b), with `rest` = 1 − x.
fn incomplete_beta(a: f64, b: f64, x: f64, rest: f64) -> f64 {
    if x <= 0.0 || rest <= 0.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    let log_front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * rest.ln();
    let front = log_front.exp();
    // The fraction converges fast on this side of the mean.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * beta_fraction(a, b, x) / a
    } else {
        1.0 - front * beta_fraction(b, a, rest) / b
    }
}

/// The continued fraction of the incomplete beta function (DLMF 8.17.22), by Lentz's method.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let guarded = |value: f64| if value.abs() < TINY { TINY } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / guarded(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    // It needs about √max(a, b) terms.
    for m in 1..1_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / guarded(1.0 + term * d);
            c = guarded(1.0 + term / c);
            fraction *= c * d;
        }
        if (fraction - before).abs() <= f64::EPSILON * fraction.abs() {
            break;
        }
    }
    fraction
}

/// ln Γ(x) for x ≥ ½: the recurrence up to 10, then Stirling's series (DLMF 5.11.1), whose next term is below 1e-16 there.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0_f64);
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    const TERMS: [f64; 7] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1_260.0,
        -1.0 / 1_680.0,
        1.0 / 1_188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
    ];
    let series = TERMS.iter().rev().fold(0.0, |sum, term| sum * square + term) * inverse;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - product.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_closed_form_for_one_and_two_degrees() {
        for t in [-40.0, -3.0, -0.4, -1e-6, 0.0, 0.7, 2.0, 25.0_f64] {
            let one = 0.5 + t.atan() / std::f64::consts::PI;
            let two = 0.5 + t / (2.0 * (2.0 + t * t).sqrt());
            // Some 50 roundings of numbers near one.
            assert!((student_cdf(t, 1.0) - one).abs() < 1e-14, "{t}");
            assert!((student_cdf(t, 2.0) - two).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn quantiles_are_those_of_the_printed_tables() {
        // One-sided 5 %: the tables have four digits after the point.
        for (freedom, t) in [(1.0, 6.3138), (4.0, 2.1318), (10.0, 1.8125), (30.0, 1.6973), (1e6, 1.6449)] {
            assert!((student_quantile(0.95, freedom) - t).abs() < 1e-4, "{freedom}");
            assert!((student_cdf(student_quantile(0.95, freedom), freedom) - 0.95).abs() < 1e-14);
        }
    }
}
