"""A material of every model, and a light of every kind."""

from shadelab import brdf
from shadelab.light import (
    AmbientLight,
    DirectionalLight,
    DiskLight,
    PointLight,
    PolygonLight,
    RectLight,
    SphereLight,
    SpotLight,
)

PUNCTUAL = {
    "point": PointLight((0.4, 2.0, 0.3), (9, 6, 3)),
    "spot": SpotLight((0.5, 2.0, -0.3), (-0.1, -1, 0.2), (9, 9, 5), 0.3, 0.9),
    "directional": DirectionalLight((0.3, -1, 0.2), (2, 3, 4)),
}
AREAS = {
    "rect": RectLight((0, 1.5, -0.5), (1, 0, 0), (0, 0.3, 0.8), (5, 4, 3)),
    "disk": DiskLight((0.3, 1.2, 0), (0, -1, 0.2), 0.4, (5, 5, 4)),
    "sphere": SphereLight((-0.2, 1.4, 0.1), 0.3, (6, 5, 5)),
    "polygon": PolygonLight([[0, 1.5, 0], [1, 1.5, 0], [0, 1.5, 1]], (7, 6, 5)),
    "ambient": AmbientLight((0.5, 0.7, 1.0)),
}
LIGHTS = PUNCTUAL | AREAS
MATERIALS = {
    "metallic roughness": brdf.MetallicRoughness((0.7, 0.5, 0.2), 0.3, 0.5),
    "diffuse": brdf.Diffuse((0.8, 0.4, 0.1)),
    "conductor": brdf.Conductor(),
    "dielectric": brdf.Dielectric(1.5),
    "rough conductor": brdf.RoughConductor(0.3, alpha_y=0.5),
    "rough dielectric": brdf.RoughDielectric(0.4),
    "oren nayar": brdf.OrenNayar((0.6, 0.6, 0.5), 0.5),
    "phong": brdf.Phong(),
    "plastic": brdf.Plastic(),
    "specular glossiness": brdf.SpecularGlossiness(),
    "compensated": brdf.RoughConductor(0.6, compensation="kulla_conty"),
    "principled": brdf.Principled((0.6, 0.3, 0.2), roughness=0.4, clearcoat=0.5),
    "compensated glass": brdf.RoughDielectric(0.6, compensation="kulla_conty"),
    "compensated principled": brdf.Principled((0.6, 0.3, 0.2), 0.5, 0.9, compensation="kulla_conty"),
}
