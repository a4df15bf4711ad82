//! Errors as text, JSON and CSV.

use serde_json::{Map, Value, json};

use crate::metrics::{ComparedPose, Comparison, Metric, Statistics, VSD_TAUS};
use crate::scene::{ObjectId, PhotoId, Scene};

/// One of the numbers that say something of many.
type StatisticOf = fn(&Statistics) -> f64;

/// Digits on screen: errors below a thousandth of their unit mean nothing to anybody.
const DECIMALS: usize = 3;

/// A table of the poses, and one of what there is to say of all.
pub fn text(scene: &Scene, comparison: &Comparison) -> String {
    let head = ["photo", "object"].into_iter().chain(Metric::ALL.map(|metric| metric.name));
    let mut rows = vec![head.map(str::to_owned).collect::<Vec<_>>()];
    for pose in &comparison.poses {
        let numbers = Metric::ALL.iter().map(|metric| decimal((metric.of)(&pose.errors)));
        rows.push(names(scene, pose).into_iter().chain(numbers).collect());
    }
    let mut text = aligned(&rows) + "\n";
    let of_all: Vec<Option<Statistics>> =
        Metric::ALL.iter().map(|metric| statistics(&comparison.poses, metric)).collect();
    let kinds: [(&str, StatisticOf); 5] = [
        ("mean", |all| all.mean),
        ("median", |all| all.median),
        ("p90", |all| all.p90),
        ("max", |all| all.max),
        ("SD", |all| all.standard_deviation),
    ];
    let head = std::iter::once("").chain(Metric::ALL.map(|metric| metric.name));
    let mut rows = vec![head.map(str::to_owned).collect::<Vec<_>>()];
    for (name, of) in kinds {
        let numbers = of_all.iter().map(|all| decimal(all.as_ref().map(of)));
        rows.push(std::iter::once(name.to_owned()).chain(numbers).collect());
    }
    text += &aligned(&rows);
    text += &format!("\n{} poses compared", comparison.poses.len());
    for (what, keys) in [("missing", &comparison.missing), ("without truth", &comparison.without_truth)] {
        if !keys.is_empty() {
            text += &format!(", {} {what}", keys.len());
        }
    }
    if let Some(recalls) = comparison.recalls() {
        text += &format!(
            "\nrecall, of all true poses: AD < 0.1 d {:.3}, AR_VSD {:.3}, AR_MSSD {:.3}, AR_MSPD {:.3}",
            recalls.ad_tenth, recalls.vsd, recalls.mssd, recalls.mspd
        );
    }
    text + "\n"
}

pub fn json(scene: &Scene, comparison: &Comparison) -> Value {
    let keys = |keys: &[(PhotoId, ObjectId)]| {
        let entry = |(photo, object): &(PhotoId, ObjectId)| json!({"photo": photo_name(scene, *photo), "object": object_name(scene, *object)});
        keys.iter().map(entry).collect::<Vec<_>>()
    };
    let recalls = comparison.recalls().map(|recalls| {
        json!({"ad_0.1d": recalls.ad_tenth, "AR_VSD": recalls.vsd, "AR_MSSD": recalls.mssd, "AR_MSPD": recalls.mspd})
    });
    json!({
        "format": "pinpose-evaluation",
        "version": 1,
        "definitions": "BOP's; VSD delta 15 mm, \"vsd\" is its mean over vsd_taus; depth_mm is signed, positive where the \
            estimate is too far; percentiles are linear, sd is of the population; recalls are of all true poses",
        "vsd_taus": VSD_TAUS,
        "poses": comparison.poses.iter().map(|pose| pose_json(scene, pose)).collect::<Vec<_>>(),
        "summary": summary(&comparison.poses),
        "by_object": by_object(scene, &comparison.poses),
        "recalls": recalls,
        "missing": keys(&comparison.missing),
        "without_truth": keys(&comparison.without_truth),
    })
}

fn pose_json(scene: &Scene, pose: &ComparedPose) -> Value {
    let [photo, object] = names(scene, pose);
    let mut entry = Map::new();
    entry.insert("photo".to_owned(), photo.into());
    entry.insert("object".to_owned(), object.into());
    entry.insert("diameter_mm".to_owned(), pose.diameter_mm.into());
    for metric in Metric::ALL {
        entry.insert(metric.name.to_owned(), json!((metric.of)(&pose.errors)));
    }
    entry.insert("vsd_by_tau".to_owned(), json!(pose.errors.vsd));
    Value::Object(entry)
}

fn summary(poses: &[ComparedPose]) -> Value {
    let entry = |metric: &Metric| {
        let all = statistics(poses, metric)?;
        Some((
            metric.name.to_owned(),
            json!({
                "count": all.count, "mean": all.mean, "median": all.median, "p90": all.p90, "max": all.max,
                "sd": all.standard_deviation,
            }),
        ))
    };
    Value::Object(Metric::ALL.iter().filter_map(entry).collect())
}

fn by_object(scene: &Scene, poses: &[ComparedPose]) -> Value {
    let mut found = Map::new();
    for object in &scene.objects {
        let own: Vec<ComparedPose> = poses.iter().filter(|pose| pose.object == object.id).cloned().collect();
        if !own.is_empty() {
            found.insert(object.name.clone(), summary(&own));
        }
    }
    Value::Object(found)
}

/// One row per pose, with VSD for each tolerance; numbers with all their digits, and nothing where there is none.
pub fn csv(scene: &Scene, comparison: &Comparison) -> String {
    let taus = VSD_TAUS.map(|tau| format!("vsd_{tau}"));
    let mut text = format!(
        "photo,object,diameter_mm,{},{}\n",
        Metric::ALL.map(|metric| metric.name).join(","),
        taus.join(",")
    );
    for pose in &comparison.poses {
        let mut fields: Vec<String> = names(scene, pose).map(|name| quoted(&name)).to_vec();
        fields.push(pose.diameter_mm.to_string());
        let number =
            |metric: &Metric| (metric.of)(&pose.errors).map_or_else(String::new, |error| error.to_string());
        fields.extend(Metric::ALL.iter().map(number));
        fields.extend(pose.errors.vsd.map(|error| error.to_string()));
        text += &(fields.join(",") + "\n");
    }
    text
}

fn statistics(poses: &[ComparedPose], metric: &Metric) -> Option<Statistics> {
    Statistics::of(poses.iter().filter_map(|pose| (metric.of)(&pose.errors)))
}

fn names(scene: &Scene, pose: &ComparedPose) -> [String; 2] {
    [photo_name(scene, pose.photo), object_name(scene, pose.object)]
}

fn photo_name(scene: &Scene, id: PhotoId) -> String {
    scene.photo(id).map(|photo| photo.name.clone()).unwrap_or_default()
}

fn object_name(scene: &Scene, id: ObjectId) -> String {
    scene.object(id).map(|object| object.name.clone()).unwrap_or_default()
}

fn decimal(number: Option<f64>) -> String {
    number.map_or_else(|| "–".to_owned(), |number| format!("{number:.DECIMALS$}"))
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Columns under one another; the first two to the left, numbers to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
    let width = |column: usize| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or_default()
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let is_number =
            |cell: &str| cell.ends_with(|c: char| c.is_ascii_digit()) && cell.parse::<f64>().is_ok();
        let cells = row.iter().zip(&widths).map(|(cell, &width)| {
            if is_number(cell) || cell == "–" {
                format!("{cell:>width$}")
            } else {
                format!("{cell:<width$}")
            }
        });
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}
