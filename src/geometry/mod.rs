//! Rays against primitives, overlap tests, and barycentric coordinates. Each test stands alone, works on the user's
//! scalars in their precision, and says where it is exact.
//!
//! - [`barycentric`]: coordinates of points in triangles
//! - [`closest_point_triangle`]: the nearest point of a triangle
//! - [`perspective_barycentric`]: from coordinates on the screen to those on the triangle
//! - [`point_in_polygon`], [`signed_area`], [`sort_by_angle`]: polygons in the plane
//! - [`line_line`], [`segment_segment`]: where two lines, or segments, come nearest
//! - [`ray_plane`], [`ray_aabb`], [`ray_obb`]: a ray against a plane, an axis-aligned and an oriented box
//! - [`ray_implicit`]: a ray against an algebraic surface
//! - [`octahedral`]: unit vectors in two numbers
//! - [`ray_polygon`]: a ray against a flat polygon, convex or not
//! - [`ray_sphere`]: a ray against a sphere: robust, quadratic, geometric
//! - [`ray_triangle`]: a ray against a triangle: watertight, Möller-Trumbore, plane
//! - [`three_planes`]: the point where planes meet
//! - [`plane_aabb`], [`plane_obb`]: the side of a plane on which boxes lie
//! - [`aabb_aabb`], [`obb_obb`], [`sphere_sphere`], [`sphere_aabb`], [`sphere_triangle`], [`triangle_aabb`],
//!   [`polygon_aabb`], [`triangle_triangle`]: whether two things have a point in common; all decided exactly ([`predicate`])
//! - [`frustum_planes`] of a projection; how [`frustum_aabb`], [`frustum_obb`], [`frustum_sphere`] lie to them: conservative
//! - [`clip_segment`], [`clip_polygon`], [`clip_homogeneous`]: what of things lies within a window
//! - [`bounding_sphere`], [`bounding_aabb`], [`bounding_obb`], [`bounding_kdop`]: volumes around points, none excluded

pub mod barycentric;
pub mod closest_point_triangle;
pub mod line_line;
pub mod octahedral;
pub mod ray_aabb;
pub mod ray_implicit;
pub mod ray_obb;
pub mod ray_plane;
pub mod perspective_barycentric;
pub mod point_in_polygon;
pub mod ray_polygon;
pub mod ray_sphere;
pub mod ray_triangle;

pub(crate) mod predicate;
pub mod three_planes;
pub mod plane_aabb;
pub mod plane_obb;
pub mod aabb_aabb;
pub mod obb_obb;
pub mod sphere_sphere;
pub mod sphere_aabb;
pub mod sphere_triangle;
pub mod triangle_aabb;
pub mod polygon_aabb;
pub mod triangle_triangle;
pub mod segment_segment;
pub mod frustum_planes;
pub mod frustum_aabb;
pub mod frustum_obb;
pub mod frustum_sphere;
pub mod clip_segment;
pub mod clip_polygon;
pub mod clip_homogeneous;
pub mod signed_area;
pub mod sort_by_angle;
pub mod bounding_aabb;
pub mod bounding_sphere;
pub mod bounding_obb;
pub mod bounding_kdop;
