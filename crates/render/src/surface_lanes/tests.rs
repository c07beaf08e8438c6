//! Lanes against single interactions.

use super::*;
use crate::{Checker, Instance, MeshId, SurfaceId, Texture, TextureId, TextureRef};
use umbriel_kernels::{
    Cuboid, Plane, Rectangle, Sphere, Surface, Torus, VectorUnit,
    glam::{Affine2, Affine3A, Mat3},
};

/// Each surface with a plain and a textured material, turned inside out and moved, too.
fn scene() -> Scene {
    let v = Vec3::new;
    let mut scene = Scene {
        surfaces: vec![
            Surface::Sphere(Sphere {
                center: v(0.5, 0.2, -0.1),
                radius: 0.7,
            }),
            Surface::Plane(Plane {
                point: v(0.0, -1.0, 0.3),
                normal: v(0.1, 2.0, 0.2),
            }),
            Surface::Rectangle(Rectangle {
                center: v(0.0, 0.5, 1.0),
                u: v(1.0, 0.0, 0.0),
                v: v(0.0, 0.6, 0.8),
            }),
            Surface::Torus(Torus {
                center: v(0.0, 0.0, 2.0),
                axis: v(0.0, 1.0, 1.0),
                major_radius: 1.0,
                minor_radius: 0.3,
            }),
            Surface::Cuboid(Cuboid {
                min: v(-0.5, -0.3, -0.1),
                max: v(0.7, 0.5, 1.1),
            }),
        ],
        textures: vec![Texture::Checker(Checker {
            even: v(0.2, 0.3, 0.4).extend(1.0),
            odd: v(0.9, 0.8, 0.7).extend(0.5),
        })],
        materials: vec![
            Material {
                transmission: 0.75,
                ..Material::default()
            },
            Material {
                base_color_texture: Some(TextureRef {
                    texture: TextureId(0),
                    uv_set: 0,
                    transform: Affine2::from_scale(Vec2::splat(8.0)),
                }),
                ..Material::default()
            },
        ],
        ..Scene::default()
    };
    for i in 0..40 {
        let turned = Affine3A::from_rotation_y(0.3) * Affine3A::from_scale(v(1.0, 0.8, 1.1));
        let moved = Affine3A::from_translation(v(0.25, 0.0, 0.1)) * turned;
        scene.instances.push(Instance {
            name: String::new(),
            geometry: Geometry::Surface(SurfaceId(i / 8)),
            transform: [Affine3A::IDENTITY, moved][i as usize & 1],
            material: MaterialId(i >> 1 & 1),
            inside_out: i & 4 != 0,
        });
    }
    scene
}

/// A hit of every instance by a ray towards it, and one by the same ray from the other side.
fn hits(bvh: &SceneBvh, instance: u32) -> Vec<(Ray, Hit)> {
    (0..50)
        .flat_map(|k| {
            let along = Vec3::new(0.3, 1.0, 0.2 + 0.01 * k as f32).normalize();
            [along, -along].map(|dir| Ray::new(Vec3::new(0.2, 0.1, 0.9) - dir * 9.0, dir))
        })
        .filter_map(|ray| {
            let mut alone = bvh.scene().clone();
            alone.instances = vec![alone.instances[instance as usize].clone()];
            let mut hit = [None];
            SceneBvh::build(&alone).intersect(&[ray], &mut hit);
            hit[0].map(|hit| (ray, Hit { instance, ..hit }))
        })
        .take(LANES)
        .collect()
}

/// Fills lanes with hits of one instance and compares on every vector unit; the number of hits compared.
fn compare(bvh: &SceneBvh, lanes: &mut SurfaceLanes, hits: &[(Ray, Hit)]) -> usize {
    let instance = hits.first().map_or(0, |(_, hit)| hit.instance);
    for unit in VectorUnit::available() {
        unit.run(
            #[inline(always)]
            || lanes.fill(bvh, instance, hits.iter().copied()),
        );
        for (i, (ray, hit)) in hits.iter().enumerate() {
            // The text tells the zeros apart.
            let (lane, single) = (lanes.get(i), surface_interaction(bvh, ray, hit));
            assert_eq!(format!("{lane:?}"), format!("{single:?}"), "{unit:?}");
        }
    }
    hits.len() * VectorUnit::available().len()
}

#[test]
fn lanes_equal_single_interactions_to_the_bit() {
    let scene = scene();
    let bvh = SceneBvh::build(&scene);
    let mut lanes = SurfaceLanes::default();
    let mut compared = 0;
    for instance in 0..scene.instances.len() as u32 {
        compared += compare(&bvh, &mut lanes, &hits(&bvh, instance));
    }
    assert!(compared > 1000, "{compared}");
}

/// Numbers in `[0, 1)`, the same in each run of the test.
struct Numbers(u32);

impl Numbers {
    fn unit(&mut self) -> f32 {
        // Source: Numerical Recipes, 3rd ed., 2007, section 7.1 (quick generators).
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f32) as usize
    }

    fn vec3(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| 2.0 * self.unit() - 1.0))
    }
}

/// Triangles without order, some of them without area.
fn mesh(numbers: &mut Numbers, with_normals: bool, with_colors: bool) -> Mesh {
    let vertices = 24;
    let mut each = |with: bool| -> Vec<Vec3> {
        let count = if with { vertices } else { 0 };
        (0..count).map(|_| numbers.vec3()).collect()
    };
    Mesh {
        positions: each(true),
        normals: each(with_normals).iter().map(|n| n.normalize()).collect(),
        uvs: [true, with_colors].map(|with| each(with).iter().map(|n| n.truncate()).collect()),
        colors: each(with_colors)
            .iter()
            .map(|c| (c * c).extend(c.y.abs()))
            .collect(),
        indices: (0..40)
            .map(|_| std::array::from_fn(|_| numbers.below(vertices) as u32))
            .collect(),
        ..Mesh::default()
    }
}

/// Meshes of each kind, seen as they are, moved, mirrored and sheared, with each material and turned inside out.
fn scene_of_meshes(numbers: &mut Numbers) -> Scene {
    let mut scene = scene();
    scene.instances.clear();
    let shear = Affine3A::from_mat3_translation(
        Mat3::from_cols(Vec3::X, Vec3::new(0.6, 1.5, 0.1), Vec3::new(0.0, -0.3, 0.2)),
        Vec3::new(1e3, -2.0, 0.1),
    );
    let transforms = [
        Affine3A::IDENTITY,
        Affine3A::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.0),
        Affine3A::from_scale(Vec3::new(-2.0, 1.0, 0.5)),
        shear,
    ];
    for i in 0..4 {
        scene.meshes.push(mesh(numbers, i & 1 != 0, i & 2 != 0));
        for k in 0..16 {
            scene.instances.push(Instance {
                name: String::new(),
                geometry: Geometry::Mesh(MeshId(i)),
                transform: transforms[k & 3],
                material: MaterialId(k as u32 >> 2 & 1),
                inside_out: k & 8 != 0,
            });
        }
    }
    scene
}

/// Up to [`LANES`] places on triangles of an instance, the same triangle now and again, seen from anywhere.
fn hits_of_triangles(numbers: &mut Numbers, triangles: usize, instance: u32) -> Vec<(Ray, Hit)> {
    let mut primitive = 0;
    let count = 1 + numbers.below(LANES);
    let hit = |_| {
        if numbers.below(4) == 0 {
            primitive = numbers.below(triangles) as u32;
        }
        let u = numbers.unit();
        let hit = Hit {
            instance,
            primitive,
            u,
            v: numbers.unit() * (1.0 - u),
            t: 1.0,
        };
        (Ray::new(numbers.vec3(), numbers.vec3().normalize()), hit)
    };
    (0..count).map(hit).collect()
}

#[test]
fn lanes_equal_single_interactions_on_meshes() {
    let mut numbers = Numbers(1);
    let scene = scene_of_meshes(&mut numbers);
    let bvh = SceneBvh::build(&scene);
    let mut lanes = SurfaceLanes::default();
    let mut compared = 0;
    for _ in 0..4 {
        for instance in 0..scene.instances.len() as u32 {
            let hits = hits_of_triangles(&mut numbers, 40, instance);
            compared += compare(&bvh, &mut lanes, &hits);
        }
    }
    assert!(compared > 4000, "{compared}");
}
