//! Bindings of `geometry`, a file for each of its faces.

mod bounds;
mod clip;
mod frustum;
mod overlap;
mod implicit;
mod lines;
mod octahedral;
mod points;
mod polygons;
mod ray_boxes;
mod rays;

use pyo3::prelude::*;

#[pymodule]
pub mod geometry {
    #[pymodule_export]
    use super::bounds::bounding_aabb;
    #[pymodule_export]
    use super::bounds::bounding_kdop;
    #[pymodule_export]
    use super::bounds::bounding_obb;
    #[pymodule_export]
    use super::bounds::bounding_sphere;
    #[pymodule_export]
    use super::bounds::kdop_directions;
    #[pymodule_export]
    use super::clip::clip_homogeneous;
    #[pymodule_export]
    use super::clip::clip_polygon;
    #[pymodule_export]
    use super::clip::clip_segment_2;
    #[pymodule_export]
    use super::clip::clip_segment_3;
    #[pymodule_export]
    use super::frustum::frustum_aabb;
    #[pymodule_export]
    use super::frustum::frustum_obb;
    #[pymodule_export]
    use super::frustum::frustum_planes;
    #[pymodule_export]
    use super::frustum::frustum_sphere;
    #[pymodule_export]
    use super::implicit::ray_implicit;
    #[pymodule_export]
    use super::implicit::ray_implicit_degree;
    #[pymodule_export]
    use super::lines::line_line;
    #[pymodule_export]
    use super::lines::segment_segment;
    #[pymodule_export]
    use super::octahedral::octahedral_decode;
    #[pymodule_export]
    use super::octahedral::octahedral_encode;
    #[pymodule_export]
    use super::octahedral::octahedral_quantize;
    #[pymodule_export]
    use super::overlap::aabb_aabb;
    #[pymodule_export]
    use super::overlap::aabb_aabb_gaps;
    #[pymodule_export]
    use super::overlap::obb_obb;
    #[pymodule_export]
    use super::overlap::obb_obb_separation;
    #[pymodule_export]
    use super::overlap::plane_aabb;
    #[pymodule_export]
    use super::overlap::plane_aabb_interval;
    #[pymodule_export]
    use super::overlap::plane_obb;
    #[pymodule_export]
    use super::overlap::plane_obb_interval;
    #[pymodule_export]
    use super::overlap::polygon_aabb;
    #[pymodule_export]
    use super::overlap::sphere_aabb;
    #[pymodule_export]
    use super::overlap::sphere_aabb_nearest;
    #[pymodule_export]
    use super::overlap::sphere_sphere;
    #[pymodule_export]
    use super::overlap::sphere_triangle;
    #[pymodule_export]
    use super::overlap::three_planes;
    #[pymodule_export]
    use super::overlap::triangle_aabb;
    #[pymodule_export]
    use super::overlap::triangle_triangle;
    #[pymodule_export]
    use super::overlap::triangle_triangle_segment;
    #[pymodule_export]
    use super::points::barycentric;
    #[pymodule_export]
    use super::points::closest_point_triangle;
    #[pymodule_export]
    use super::points::perspective_barycentric;
    #[pymodule_export]
    use super::polygons::point_in_polygon;
    #[pymodule_export]
    use super::polygons::ray_polygon;
    #[pymodule_export]
    use super::polygons::signed_area;
    #[pymodule_export]
    use super::polygons::sort_by_angle;
    #[pymodule_export]
    use super::ray_boxes::ray_aabb;
    #[pymodule_export]
    use super::ray_boxes::ray_obb;
    #[pymodule_export]
    use super::rays::ray_plane;
    #[pymodule_export]
    use super::rays::ray_sphere;
    #[pymodule_export]
    use super::rays::ray_triangle;
}
