//! Typed indices into the vectors of a [`Scene`](crate::Scene).

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);

        impl $name {
            /// The position in its vector.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// Position in [`Scene::meshes`](crate::Scene::meshes).
    MeshId,
    /// Position in [`Scene::surfaces`](crate::Scene::surfaces).
    SurfaceId,
    /// Position in [`Scene::instances`](crate::Scene::instances).
    InstanceId,
    /// Position in [`Scene::materials`](crate::Scene::materials).
    MaterialId,
    /// Position in [`Scene::textures`](crate::Scene::textures).
    TextureId,
}
