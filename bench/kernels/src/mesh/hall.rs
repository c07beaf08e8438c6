//! A hall full of long thin triangles: fluted columns, blinds, stairs, chairs, floor tiles and diagonal cables.
//!
//! Their boxes overlap much, which is what splits through triangles are for.

use super::noise::{scramble, unit};
use super::{Shape, View};
use std::f32::consts::TAU;
use umbriel_kernels::glam::{Quat, Vec3};

/// Length, height and width in metres; the floor's middle is the origin, the length runs along x.
const ROOM: Vec3 = Vec3::new(40.0, 10.0, 16.0);

pub const VIEW: View = View {
    eye: Vec3::new(-17.5, 2.4, 2.2),
    target: Vec3::new(0.0, 3.4, -1.0),
    angle: 75.0,
    light: Vec3::new(-4.0, 7.5, 1.0),
    occlusion_length: 2.0,
};

/// About `size` triangles: each part has its share.
pub fn shape(size: usize) -> Shape {
    let share = |part: f32| size as f32 * part;
    let mut shape = Shape::default();
    walls(&mut shape);
    columns(&mut shape, share(0.3));
    blinds(&mut shape, share(0.25));
    tiles(&mut shape, share(0.18));
    stairs(&mut shape, share(0.1));
    cables(&mut shape, share(0.007).max(288.0));
    let left = size.saturating_sub(shape.indices.len());
    chairs(&mut shape, left as f32);
    shape
}

fn walls(shape: &mut Shape) {
    let half = ROOM / 2.0;
    let thick = 0.2;
    let (low, high) = (Vec3::new(-half.x, 0.0, -half.z), Vec3::new(half.x, ROOM.y, half.z));
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let rest = Vec3::ONE - axis;
        shape.block(low - thick, low * axis + (high + thick) * rest);
        shape.block(high * axis + (low - thick) * rest, high + thick);
    }
}

/// Two rows of columns whose flutes run over the whole height or in as many drums as the share pays for.
fn columns(shape: &mut Shape, share: f32) {
    let pairs = (share / 40_000.0).sqrt().mul_add(6.0, 4.0).min(14.0) as u32;
    let sides = (share.sqrt() / 3.0).clamp(6.0, 40.0) as u32 * 8;
    let drums = (share / (pairs * 2 * sides * 2) as f32).round().max(1.0) as u32;
    for (k, row) in (0..pairs).flat_map(|k| [(k, -1.0), (k, 1.0)]) {
        let x = ROOM.x * ((k as f32 + 0.5) / pairs as f32 - 0.5);
        let foot = Vec3::new(x, 0.0, row * 4.6);
        shape.grid(sides, drums, |i, j| {
            let turn = (i % sides) as f32 / sides as f32;
            let radius = 0.42 - 0.05 * (turn * TAU * (sides / 8) as f32).sin().abs();
            let height = ROOM.y * j as f32 / drums as f32;
            let taper = 1.0 - 0.012 * height;
            foot + Vec3::new(radius * taper * (turn * TAU).cos(), height, -radius * taper * (turn * TAU).sin())
        });
    }
}

/// Tilted slats before the windows of both long walls.
fn blinds(shape: &mut Shape, share: f32) {
    let slats = (share / 12.0).max(2.0);
    let windows = (slats / 30.0).sqrt().clamp(2.0, 40.0) as u32;
    let rows = (slats / (2 * windows) as f32).round().max(1.0) as u32;
    let (width, pitch) = (ROOM.x / windows as f32, 6.0 / rows as f32);
    let tilt = Quat::from_rotation_x(0.7);
    for (window, row) in (0..windows).flat_map(|w| (0..rows).map(move |r| (w, r))) {
        for side in [-1.0, 1.0] {
            let x = ROOM.x * ((window as f32 + 0.5) / windows as f32 - 0.5);
            let center = Vec3::new(x, 2.5 + pitch * (row as f32 + 0.5), side * (ROOM.z / 2.0 - 0.3));
            let sag = Quat::from_rotation_z(0.01 * (unit(scramble(window * 7919 + row)) - 0.5));
            let turn = sag * tilt;
            let half = Vec3::new(0.48 * width, 0.0008, 0.45 * pitch);
            shape.solid(center, [turn * Vec3::X * half.x, turn * Vec3::Y * half.y, turn * Vec3::Z * half.z]);
        }
    }
}

/// Slabs with joints between them, none quite level with the next.
fn tiles(shape: &mut Shape, share: f32) {
    let edge = (ROOM.x * ROOM.z / (share / 12.0).max(1.0)).sqrt();
    let (columns, rows) = ((ROOM.x / edge).round().max(1.0) as u32, (ROOM.z / edge).round().max(1.0) as u32);
    let size = Vec3::new(ROOM.x / columns as f32, 0.0, ROOM.z / rows as f32);
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let low = Vec3::new(-ROOM.x / 2.0, 0.0, -ROOM.z / 2.0) + size * Vec3::new(i as f32, 0.0, j as f32);
        let level = 0.012 + 0.002 * unit(scramble(i * 65_537 + j));
        shape.block(low + 0.01 * size, low + 0.99 * size + Vec3::Y * level);
    }
}

/// A wide flight at the far end; every step has balusters on both sides and the rails run slantwise.
fn stairs(shape: &mut Shape, share: f32) {
    let steps = (share / 12.0).sqrt().clamp(8.0, 60.0) as u32;
    let posts = ((share / 12.0 / steps as f32 - 1.0) / 2.0).clamp(1.0, 400.0) as u32;
    let (rise, run) = (5.0 / steps as f32, 8.0 / steps as f32);
    for step in 0..steps {
        let (x, y) = (11.0 + run * step as f32, rise * step as f32);
        shape.block(Vec3::new(x, y, -3.0), Vec3::new(x + run, y + rise, 3.0));
        for (post, side) in (0..posts).flat_map(|p| [(p, -2.9), (p, 2.9)]) {
            let pitch = run / posts as f32;
            let center = Vec3::new(x + pitch * (post as f32 + 0.5), y + rise + 0.5, side);
            let thin = 0.3 * pitch.min(0.06);
            shape.solid(center, [Vec3::X * thin, Vec3::Y * 0.5, Vec3::Z * thin]);
        }
    }
    for side in [-2.9, 2.9] {
        rod(shape, Vec3::new(11.0, rise + 1.0, side), Vec3::new(19.0, 6.0, side), 0.04);
    }
}

/// From wall to wall, floor to ceiling, in any direction: 12 triangles each.
fn cables(shape: &mut Shape, share: f32) {
    for cable in 0..(share / 12.0) as u32 {
        let random = |k: u32| unit(scramble(cable * 8 + k)) - 0.5;
        let from = Vec3::new(random(0) * ROOM.x, 4.0 + 5.0 * (random(1) + 0.5), -ROOM.z / 2.0);
        let to = Vec3::new(random(2) * ROOM.x, 4.0 + 5.0 * (random(3) + 0.5), ROOM.z / 2.0);
        rod(shape, from, to, 0.012);
    }
}

/// A long box with square section.
fn rod(shape: &mut Shape, from: Vec3, to: Vec3, radius: f32) {
    let along = (to - from) / 2.0;
    let across = along.normalize().any_orthonormal_vector() * radius;
    let third = along.normalize().cross(across);
    shape.solid(from + along, [along, across, third]);
}

/// Rows of chairs, turned this way and that.
fn chairs(shape: &mut Shape, share: f32) {
    let count = (share / 144.0) as u32;
    let columns = (count as f32 * 2.5).sqrt().ceil().max(1.0) as u32;
    let rows = count.div_ceil(columns).max(1);
    let scale = (22.0 / columns as f32).min(7.0 / rows as f32).min(0.9) / 0.9;
    for chair in 0..count {
        let (i, j) = (chair % columns, chair / columns);
        let x = -14.0 + 22.0 * (i as f32 + 0.5) / columns as f32;
        let z = -3.5 + 7.0 * (j as f32 + 0.5) / rows as f32;
        let turn = Quat::from_rotation_y(0.8 * (unit(scramble(chair)) - 0.5));
        one_chair(shape, Vec3::new(x, 0.014, z), turn, scale);
    }
}

fn one_chair(shape: &mut Shape, foot: Vec3, turn: Quat, scale: f32) {
    let mut part = |center: [f32; 3], half: [f32; 3]| {
        let axes = [Vec3::X * half[0], Vec3::Y * half[1], Vec3::Z * half[2]];
        shape.solid(foot + turn * Vec3::from(center) * scale, axes.map(|axis| turn * axis * scale));
    };
    for (x, z) in [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)] {
        part([x, 0.22, z], [0.018, 0.22, 0.018]);
    }
    part([0.0, 0.45, 0.0], [0.23, 0.015, 0.23]);
    part([0.21, 0.95, 0.0], [0.012, 0.03, 0.22]);
    for slat in 0..6 {
        part([0.21, 0.7, -0.19 + 0.076 * slat as f32], [0.008, 0.24, 0.012]);
    }
}
