//! Finds vertices at the same place.

use glam::Vec3;

/// Numbers the distinct positions in the order of their first vertex: the number of each vertex's place, and how many
/// places there are. Positions are the same if they are equal, bit for bit but for the sign of zero.
///
/// Files split vertices along texture seams, and formats without shared vertices split all of them; shading should not
/// show it.
pub fn weld(positions: &[Vec3]) -> (Vec<u32>, usize) {
    const EMPTY: u32 = u32::MAX;
    let capacity = (positions.len() * 2).next_power_of_two();
    let mask = capacity - 1;
    // An open hash table that holds, per place, the number of its first vertex.
    let mut first_vertex_at = vec![EMPTY; capacity];
    let mut place_of_vertex: Vec<u32> = Vec::with_capacity(positions.len());
    let mut place_count = 0;
    for (vertex, &position) in positions.iter().enumerate() {
        let mut slot = hash(position) & mask;
        let place = loop {
            match first_vertex_at[slot] {
                EMPTY => {
                    first_vertex_at[slot] = vertex as u32;
                    place_count += 1;
                    break place_count as u32 - 1;
                }
                first if positions[first as usize] == position => break place_of_vertex[first as usize],
                _ => slot = (slot + 1) & mask,
            }
        };
        place_of_vertex.push(place);
    }
    (place_of_vertex, place_count)
}

fn hash(position: Vec3) -> usize {
    // Adding zero makes −0 into +0. The multipliers are odd and random; the fold brings the well mixed upper half down.
    let [x, y, z] = position.to_array().map(|value| u64::from((value + 0.0).to_bits()));
    let mixed = (x.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ y.rotate_left(32))
        .wrapping_mul(0xD6E8_FEB8_6659_FD93)
        .wrapping_add(z)
        .wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
    ((mixed >> 32) ^ mixed) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_share_a_number() {
        let positions = [Vec3::X, Vec3::ZERO, Vec3::X, Vec3::new(-0.0, 0.0, -0.0), Vec3::Y];
        assert_eq!(weld(&positions), (vec![0, 1, 0, 1, 2], 3));
        assert_eq!(weld(&[]), (vec![], 0));
    }
}
