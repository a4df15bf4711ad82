//! Linear algebra of a handful of unknowns: Cholesky and Jacobi on small arrays.

#![allow(clippy::needless_range_loop, reason = "sums over rows and columns read as in the books")]

/// Row by row.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// The lower factor L of `a = L Lᵀ`; `None` where `a` is not positive definite to working precision.
pub fn cholesky<const N: usize>(a: &Matrix<N>) -> Option<Matrix<N>> {
    let mut lower = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= lower[i][k] * lower[j][k];
            }
            if i == j {
                // What is left of the diagonal is rounding if it is this small beside what it was: no information.
                if sum <= 1e-14 * a[i][i] || !sum.is_finite() {
                    return None;
                }
                lower[i][i] = sum.sqrt();
            } else {
                lower[i][j] = sum / lower[j][j];
            }
        }
    }
    Some(lower)
}

/// The x of `a x = b` for a symmetric positive definite `a`; `None` for any other.
pub fn solve<const N: usize>(a: &Matrix<N>, b: &[f64; N]) -> Option<[f64; N]> {
    let lower = cholesky(a)?;
    let mut x = *b;
    for i in 0..N {
        for k in 0..i {
            x[i] -= lower[i][k] * x[k];
        }
        x[i] /= lower[i][i];
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] -= lower[k][i] * x[k];
        }
        x[i] /= lower[i][i];
    }
    x.iter().all(|value| value.is_finite()).then_some(x)
}

/// The inverse of a symmetric positive definite matrix; `None` for any other.
pub fn inverse<const N: usize>(a: &Matrix<N>) -> Option<Matrix<N>> {
    let mut inverse = [[0.0; N]; N];
    for column in 0..N {
        let mut unit = [0.0; N];
        unit[column] = 1.0;
        let x = solve(a, &unit)?;
        for row in 0..N {
            inverse[row][column] = x[row];
        }
    }
    Some(inverse)
}

/// `j a jᵀ`: how a covariance `a` of x becomes that of `j x`.
pub fn congruent<const M: usize, const N: usize>(j: &[[f64; N]; M], a: &Matrix<N>) -> Matrix<M> {
    let mut result = [[0.0; M]; M];
    for row in 0..M {
        for column in 0..M {
            for k in 0..N {
                for l in 0..N {
                    result[row][column] += j[row][k] * a[k][l] * j[column][l];
                }
            }
        }
    }
    result
}

/// Eigenvalues of a symmetric matrix, the smallest first, and the unit eigenvectors that go with them, one per row.
///
/// Cyclic Jacobi rotations (Golub and Van Loan, *Matrix Computations*, section 8.5): slow for large matrices, accurate and
/// safe for small ones, also with repeated eigenvalues.
pub fn symmetric_eigen<const N: usize>(a: &Matrix<N>) -> ([f64; N], Matrix<N>) {
    let mut a = *a;
    let mut vectors = [[0.0; N]; N];
    for i in 0..N {
        vectors[i][i] = 1.0;
    }
    // Convergence is quadratic; a matrix of numbers is through after some eight sweeps.
    for _ in 0..40 {
        let off_diagonal: f64 =
            (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j].powi(2)).sum();
        let diagonal: f64 = (0..N).map(|i| a[i][i].powi(2)).sum();
        if off_diagonal <= 1e-32 * diagonal || !diagonal.is_finite() {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, &mut vectors, p, q);
            }
        }
    }
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    // By insertion: of so few the library's way takes longer, and six kilobytes of the page for each size.
    for end in 1..N {
        let mut place = end;
        while place > 0
            && a[order[place - 1]][order[place - 1]].total_cmp(&a[order[place]][order[place]]).is_gt()
        {
            order.swap(place - 1, place);
            place -= 1;
        }
    }
    (order.map(|i| a[i][i]), order.map(|i| vectors[i]))
}

/// One Jacobi rotation, which makes `a[p][q]` zero.
fn rotate<const N: usize>(a: &mut Matrix<N>, vectors: &mut Matrix<N>, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..N {
        let (kp, kq) = (a[k][p], a[k][q]);
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for k in 0..N {
        let (pk, qk) = (a[p][k], a[q][k]);
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        let (vp, vq) = (vectors[p][k], vectors[q][k]);
        vectors[p][k] = c * vp - s * vq;
        vectors[q][k] = s * vp + c * vq;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// B Bᵀ of any B is positive semidefinite.
    fn product(b: &Matrix<4>) -> Matrix<4> {
        let mut identity = [[0.0; 4]; 4];
        (0..4).for_each(|i| identity[i][i] = 1.0);
        congruent(b, &identity)
    }

    proptest! {
        #[test]
        fn solutions_and_eigenvectors_satisfy_their_equations(b: [[i8; 4]; 4], x: [i8; 4]) {
            let mut a = product(&b.map(|row| row.map(f64::from)));
            (0..4).for_each(|i| a[i][i] += 1.0);
            let x = x.map(f64::from);
            let times = |v: &[f64; 4]| a.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum::<f64>());
            let found = solve(&a, &times(&x)).unwrap();
            // The condition is at most about 1e5 here (entries to 127, plus one on the diagonal), of 16 digits.
            prop_assert!(found.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-7), "{found:?} {x:?}");
            let (values, vectors) = symmetric_eigen(&a);
            prop_assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
            for (value, vector) in values.iter().zip(&vectors) {
                let stretched = times(vector);
                // Rounding of numbers up to 4 · 127² · 4.
                prop_assert!(stretched.iter().zip(vector).all(|(s, v)| (s - value * v).abs() < 1e-8));
                prop_assert!((vector.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert_eq!(solve(&[[1.0, 2.0], [2.0, 4.0]], &[1.0, 1.0]), None);
        assert_eq!(solve(&[[f64::NAN, 0.0], [0.0, 1.0]], &[1.0, 1.0]), None);
        assert_eq!(inverse(&[[-1.0]]), None);
        assert_eq!(inverse(&[[4.0]]), Some([[0.25]]));
    }
}
