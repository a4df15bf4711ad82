//! What was found of a mesh's symmetries, on its way from the worker.

use glam::DVec3;

use super::wire::{Reader, Writer};
use crate::formats::NamedFile;
use crate::mesh::{Mesh, MeshData};
use crate::scene::{Fold, MeshAsset, SymmetryAxis};
use crate::solve::symmetry::{FoundSymmetries, FoundSymmetry, find_symmetries};

/// The mesh as it is now, after any change of its frame, in place of a file.
pub fn request(mesh: &MeshAsset) -> NamedFile {
    let mut writer = Writer::default();
    writer.items(mesh.mesh.positions_mm());
    writer.items(mesh.mesh.triangles());
    NamedFile { name: mesh.file_name.clone(), bytes: writer.finish().into() }
}

pub fn write(file: &NamedFile) -> Result<Vec<u8>, String> {
    let mut reader = Reader::new(&file.bytes);
    let (Some(positions_mm), Some(triangles)) = (reader.items(), reader.items()) else {
        return Err("the request to the worker was damaged".to_owned());
    };
    let mesh = Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() });
    let found = find_symmetries(&mesh.map_err(|error| error.to_string())?);
    let mut writer = Writer::default();
    writer.number(found.diameter_mm);
    write_list(&mut writer, &found.found);
    write_list(&mut writer, &found.nearly);
    Ok(writer.finish())
}

pub fn read(reader: &mut Reader<'_>) -> Option<FoundSymmetries> {
    Some(FoundSymmetries {
        diameter_mm: reader.number()?,
        found: read_list(reader)?,
        nearly: read_list(reader)?,
    })
}

fn write_list(writer: &mut Writer, list: &[FoundSymmetry]) {
    writer.number(list.len() as f64);
    for FoundSymmetry { axis, worst_mm, mean_mm } in list {
        let times = match axis.fold {
            Fold::Times(times) => times,
            Fold::Continuous => 0,
        };
        let numbers = axis.axis.to_array().into_iter().chain(axis.through_mm.to_array());
        numbers.chain([f64::from(times), *worst_mm, *mean_mm]).for_each(|number| writer.number(number));
    }
}

fn read_list(reader: &mut Reader<'_>) -> Option<Vec<FoundSymmetry>> {
    let count = reader.number()? as usize;
    (0..count).map(|_| read_one(reader)).collect()
}

fn read_one(reader: &mut Reader<'_>) -> Option<FoundSymmetry> {
    let mut vector = || Some(DVec3::new(reader.number()?, reader.number()?, reader.number()?));
    let (axis, through_mm) = (vector()?, vector()?);
    let fold = match reader.number()? as u32 {
        0 => Fold::Continuous,
        times => Fold::Times(times),
    };
    let axis = SymmetryAxis { axis, through_mm, fold };
    Some(FoundSymmetry { axis, worst_mm: reader.number()?, mean_mm: reader.number()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_survives_the_way_through_the_worker() {
        let found = |fold| FoundSymmetry {
            axis: SymmetryAxis { axis: DVec3::Y, through_mm: DVec3::new(1.0, 2.0, 3.0), fold },
            worst_mm: 0.25,
            mean_mm: 0.125,
        };
        let all = FoundSymmetries {
            diameter_mm: 90.0,
            found: vec![found(Fold::Continuous), found(Fold::Times(2))],
            nearly: vec![found(Fold::Times(6))],
        };
        let mut writer = Writer::default();
        writer.number(all.diameter_mm);
        write_list(&mut writer, &all.found);
        write_list(&mut writer, &all.nearly);
        let bytes = writer.finish();
        assert_eq!(read(&mut Reader::new(&bytes)), Some(all));
        assert_eq!(read(&mut Reader::new(&bytes[..bytes.len() - 1])), None);
        assert!(write(&NamedFile { name: "a".to_owned(), bytes: [1, 2, 3][..].into() }).is_err());
    }
}
