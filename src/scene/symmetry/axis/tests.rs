use super::*;

const AROUND: BoundingSphere = BoundingSphere { center: DVec3::new(5.0, 0.0, 2.0), radius: 40.0 };

fn axis(direction: [f64; 3], times: u32) -> SymmetryAxis {
    let fold = if times == 0 { Fold::Continuous } else { Fold::Times(times) };
    SymmetryAxis { axis: DVec3::from_array(direction).normalize(), through_mm: AROUND.center, fold }
}

fn of(axes: &[SymmetryAxis]) -> Result<Symmetries, SymmetryError> {
    let mut symmetries = Symmetries::default();
    axes.iter().try_for_each(|axis| symmetries.add_axis(axis, &AROUND))?;
    Ok(symmetries)
}

#[test]
fn products_of_turns_are_turns_too() {
    // The groups of turns of the solids, each from two axes, less the identity.
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    for (name, axes, turns) in [
        ("prism", vec![axis([0.0, 0.0, 1.0], 6), axis([1.0, 0.0, 0.0], 2)], 11),
        ("box", vec![axis([0.0, 0.0, 1.0], 2), axis([1.0, 0.0, 0.0], 2)], 3),
        ("tetrahedron", vec![axis([1.0, 1.0, 1.0], 3), axis([1.0, -1.0, -1.0], 3)], 11),
        ("cube", vec![axis([0.0, 0.0, 1.0], 4), axis([1.0, 0.0, 0.0], 4)], 23),
        ("icosahedron", vec![axis([0.0, 1.0, golden], 5), axis([1.0, golden, 0.0], 5)], 59),
    ] {
        assert_eq!(of(&axes).unwrap().discrete.len(), turns, "{name}");
    }
}

#[test]
fn a_continuous_axis_has_two_ends_at_most() {
    let tin = of(&[axis([0.0, 0.0, 1.0], 0), axis([1.0, 0.0, 0.0], 2), axis([1.0, 1.0, 0.0], 2)]).unwrap();
    assert_eq!((tin.continuous.len(), tin.discrete.len()), (1, 1), "one flip, from which the others follow");
    // The same in another order.
    let tin = of(&[axis([1.0, 0.0, 0.0], 2), axis([0.0, 0.0, 1.0], 4), axis([0.0, 0.0, 1.0], 0)]).unwrap();
    assert_eq!((tin.continuous.len(), tin.discrete.len()), (1, 1));
    let ball = of(&[axis([0.0, 0.0, 1.0], 0), axis([1.0, 0.0, 0.0], 0), axis([1.0, 2.0, 3.0], 7)]).unwrap();
    assert_eq!((ball.continuous.len(), ball.discrete.len()), (2, 0));
}

#[test]
fn what_does_not_go_together_is_refused_and_changes_nothing() {
    let mut prism = of(&[axis([0.0, 0.0, 1.0], 6)]).unwrap();
    let before = prism.clone();
    // A crystal has no five-fold axis beside a six-fold one.
    assert_eq!(prism.add_axis(&axis([1.0, 0.0, 0.0], 5), &AROUND), Err(SymmetryError::DoNotGoTogether));
    let beside = SymmetryAxis { through_mm: DVec3::new(30.0, 0.0, 0.0), ..axis([0.0, 0.0, 1.0], 2) };
    assert_eq!(prism.add_axis(&beside, &AROUND), Err(SymmetryError::DoNotGoTogether));
    for bad in [axis([0.0, 0.0, 1.0], 1), SymmetryAxis { axis: DVec3::ZERO, ..axis([1.0, 0.0, 0.0], 2) }] {
        assert_eq!(prism.add_axis(&bad, &AROUND), Err(SymmetryError::NoAxis));
    }
    assert_eq!(prism, before);
}

#[test]
fn axes_are_read_off_the_turns_and_taken_out() {
    let mut nut = of(&[axis([0.0, 0.0, 1.0], 6), axis([1.0, 0.0, 0.0], 2)]).unwrap();
    let axes = nut.axes(&AROUND);
    assert_eq!(axes.len(), 7);
    assert_eq!(axes[0].fold, Fold::Times(6));
    assert!(axes[0].axis.distance(DVec3::Z) < 1e-9);
    // The axis is through the object's middle; its point is the one nearest to the origin.
    assert!(axes[0].through_mm.distance(DVec3::new(5.0, 0.0, 0.0)) < 1e-9);
    assert!(axes[1..].iter().all(|axis| axis.fold == Fold::Times(2) && axis.axis.z.abs() < 1e-9));
    nut.remove_axis(&axes[0], &AROUND);
    assert_eq!((nut.discrete.len(), nut.axes(&AROUND).len()), (6, 6));
}

#[test]
fn a_slightly_wrong_axis_is_known_again() {
    let nut = of(&[axis([0.0, 0.0, 1.0], 6)]).unwrap();
    // Half a degree: what an axis that was found in a scan may be off.
    let tilted = axis([0.009, 0.0, 1.0], 3);
    assert!(tilted.turns().iter().all(|turn| nut.holds(turn, &AROUND)));
    assert!(!axis([0.0, 0.0, 1.0], 4).turns().iter().all(|turn| nut.holds(turn, &AROUND)));
}
