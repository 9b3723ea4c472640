//! A random scene, written in one syntax and the other and read again, keeps every value.

use std::time::{Duration, Instant};

use crate::{
    diagnostic::Code,
    scene::{
        convert::{LostComments, convert},
        format::{
            animation::{AnimationModel, Interpolation, Key, OrbitModel, Track},
            backdrop::{BackdropModel, ImageBackdropModel, SkyBackdropModel},
            camera::CameraModel,
            color::ColorModel,
            color_by::{ColorByModel, ColormapModel},
            field::Name,
            fit::{
                FitModel, OrthographicProjectionModel, PerspectiveProjectionModel, ProjectionModel,
            },
            geometry::{
                BoxModel, CapsuleModel, ConeModel, CylinderModel, CylindersModel, DifferenceModel,
                DiscModel, EllipsoidModel, GeometryModel, GroupModel, InstancesModel,
                IntersectionModel, MeshModel, PlaneModel, RectangleModel, SphereModel, SphereRest,
                SpheresModel, TriangleModel, UnionModel,
            },
            image::{ImageModel, ToneMappingModel},
            light::{
                AmbientLightModel, DirectionalLightModel, EnvironmentLightModel, FalloffModel,
                HeadlightLightModel, LightModel, PointLightModel, SkyModel, SpotLightModel,
            },
            lighting::{
                BoxFilterModel, DirectModel, FilterModel, GaussianFilterModel, LightingModel,
                PathModel,
            },
            map::Map,
            material::{
                EmissiveModel, FlatModel, GlassModel, MaterialModel, MatteModel, MetalModel,
                MirrorModel, NamedModel, PhongModel, PlasticModel, PrincipledModel,
            },
            numbers::{ScaleModel, Triple},
            orthographic::OrthographicModel,
            outlines::OutlinesModel,
            perspective::PerspectiveModel,
            rare::Rare,
            scene::Model,
            texture::{
                CheckerModel, ImageTextureModel, MappingModel, NaturalMappingModel,
                PlanarMappingModel, SphericalMappingModel, TexelInterpolationModel, TexelWrapModel,
                TextureModel,
            },
            transform::{MatrixModel, RotateModel, TransformModel},
            warning::WarningName,
        },
        tests::oracle,
    },
    text::{
        print,
        syntax::{Syntax, parse},
    },
    tracer::random::{Rng, cases},
};

/// Number of random models; `STRAHL_CASES` overrides it.
const CASES: usize = 3_000;

impl Rng {
    fn maybe<T>(&mut self, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        (self.below(2) == 0).then(|| make(self))
    }

    fn number(&mut self) -> f64 {
        const RARE: &[f64] = &[
            0.0,
            -0.0,
            5e-324,
            -5e-324,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            0.1,
            1e21,
            1e16,
            -1e15,
            123_456_789_012_345_680.0,
            -9_007_199_254_740_993.0,
            9_223_372_036_854_775_808.0,
            18_446_744_073_709_551_616.0,
            -9_223_372_036_854_777_856.0,
            1.0,
            -640.0,
            1e-7,
            2.5e300,
        ];
        match self.below(4) {
            0 => RARE[self.below(RARE.len())],
            1 => self.below(2000) as f64 - 1000.0,
            2 => self.next() as i64 as f64,
            _ => {
                let number = f64::from_bits(self.next());
                if number.is_finite() { number } else { 0.5 }
            }
        }
    }

    fn triple(&mut self) -> Triple {
        [self.number(), self.number(), self.number()]
    }

    fn color(&mut self) -> ColorModel {
        if self.below(2) == 0 {
            let [r, g, b, ..] = self.next().to_le_bytes();
            ColorModel::Hex([r, g, b])
        } else {
            ColorModel::Channels(self.triple())
        }
    }

    fn list<T>(&mut self, mut make: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.below(4)).map(|_| make(self)).collect()
    }

    fn color_by(&mut self) -> ColorByModel {
        ColorByModel {
            column: self.name().to_string().into(),
            range: self.maybe(|rng| [rng.number(), rng.number()]),
            map: self.maybe(|rng| match rng.below(3) {
                0 => ColormapModel::Viridis,
                1 => ColormapModel::Gray,
                _ => ColormapModel::Colors(rng.list(Self::color)),
            }),
            missing: self.maybe(Self::color),
        }
    }

    fn name(&mut self) -> Name {
        const NAMES: &[&str] = &["", "ball", "robot/arm \"2\" 1.0", "a\\ // \n\t\u{1} 变 🙂"];
        Box::new(NAMES[self.below(NAMES.len())].into())
    }

    fn side(&mut self) -> u32 {
        [0, 1, 640, 1_000_000, u32::MAX][self.below(5)]
    }

    fn keys<T>(&mut self, value: impl Fn(&mut Self) -> T) -> Vec<Key<T>> {
        use Interpolation::{Linear, Smooth, Step};
        let count = self.below(4);
        let key = |rng: &mut Self| Key {
            time: rng.number(),
            value: value(rng),
            step: rng.maybe(|rng| rng.one(&[Step, Linear, Smooth])),
        };
        (0..count).map(|_| key(self)).collect()
    }

    fn animation(&mut self) -> AnimationModel {
        let tracks = [
            ("camera.fov", Track::Numbers(self.keys(Self::number))),
            ("geometries", Track::Unknown),
            (
                "cameras[\"a\\n\"].eye",
                Track::Points(self.keys(Self::triple)),
            ),
            (
                "geometries[3].normal",
                Track::Directions(self.keys(Self::triple)),
            ),
            (
                "geometries[0].transform.scale",
                Track::Scales(self.keys(|rng| match rng.below(2) {
                    0 => ScaleModel::Uniform(rng.number()),
                    _ => ScaleModel::Axes(rng.triple()),
                })),
            ),
            ("background", Track::Colors(self.keys(Self::color))),
            ("x.eye[0]", Track::Numbers(self.keys(Self::number))),
        ];
        let tracks = tracks.map(|(path, track)| (path.into(), track));
        AnimationModel {
            fps: self.maybe(Self::number),
            frames: self.side(),
            tracks: {
                let tracks = tracks.into_iter().skip(self.below(8)).collect();
                self.maybe(|_| Map(tracks))
            },
            orbit: self.maybe(|rng| OrbitModel {
                around: rng.triple(),
                axis: rng.maybe(Self::triple),
                turns: rng.maybe(Self::number),
            }),
        }
    }

    fn material(&mut self) -> MaterialModel {
        match self.below(8) {
            0 => MaterialModel::Matte(MatteModel {
                color: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
            }),
            6 => match self.below(3) {
                0 => MaterialModel::Metal(MetalModel {
                    color: self.maybe(Self::color),
                    texture: self.maybe(Self::texture),
                    roughness: self.maybe(Self::number),
                }),
                1 => MaterialModel::Plastic(PlasticModel {
                    color: self.maybe(Self::color),
                    texture: self.maybe(Self::texture),
                    roughness: self.maybe(Self::number),
                    ior: self.maybe(Self::number),
                }),
                _ => MaterialModel::Principled(PrincipledModel {
                    color: self.maybe(Self::color),
                    texture: self.maybe(Self::texture),
                    metallic: self.maybe(Self::number),
                    roughness: self.maybe(Self::number),
                    ior: self.maybe(Self::number),
                }),
            },
            1 => MaterialModel::Phong(PhongModel {
                diffuse: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
                specular: self.maybe(Self::color),
                exponent: self.maybe(Self::number),
                reflection: self.maybe(Self::color),
            }),
            2 => MaterialModel::Mirror(MirrorModel {
                color: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
            }),
            3 => MaterialModel::Glass(GlassModel {
                color: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
                roughness: self.maybe(Self::number),
                ior: self.maybe(Self::number),
            }),
            4 => MaterialModel::Flat(FlatModel {
                color: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
            }),
            5 => MaterialModel::Emissive(EmissiveModel {
                color: self.maybe(Self::color),
                texture: self.maybe(Self::texture),
                intensity: self.maybe(Self::number),
            }),
            _ => MaterialModel::Named(NamedModel(*self.name())),
        }
    }

    fn texture(&mut self) -> Box<TextureModel> {
        let mapping = self.maybe(|rng| match rng.below(3) {
            0 => MappingModel::Natural(NaturalMappingModel {}),
            1 => MappingModel::Planar(PlanarMappingModel {
                origin: rng.triple(),
                u: rng.triple(),
                v: rng.triple(),
            }),
            _ => MappingModel::Spherical(SphericalMappingModel {
                center: rng.triple(),
                up: rng.maybe(Self::triple),
                front: rng.maybe(Self::triple),
            }),
        });
        Box::new(match self.below(2) {
            0 => TextureModel::Checker(CheckerModel {
                even: self.maybe(Self::color),
                odd: self.maybe(Self::color),
                size: self.maybe(Self::number),
                mapping,
            }),
            _ => TextureModel::Image(ImageTextureModel {
                file: "wood 1.png".into(),
                interpolation: self.maybe(|_| TexelInterpolationModel::Nearest),
                wrap: self.maybe(|_| TexelWrapModel::Clamp),
                mapping,
            }),
        })
    }

    fn transform(&mut self) -> TransformModel {
        let row = |rng: &mut Self| [rng.number(), rng.number(), rng.number(), rng.number()];
        TransformModel {
            translate: self.maybe(Self::triple),
            rotate: self.maybe(|rng| RotateModel {
                axis: rng.triple(),
                angle: rng.number(),
            }),
            scale: self.maybe(|rng| match rng.below(2) {
                0 => ScaleModel::Uniform(rng.number()),
                _ => ScaleModel::Axes(rng.triple()),
            }),
            matrix: self.maybe(|rng| MatrixModel([row(rng), row(rng), row(rng)]).into()),
        }
    }

    fn backdrop(&mut self) -> BackdropModel {
        match self.below(2) {
            0 => BackdropModel::Sky(SkyBackdropModel {
                zenith: self.color(),
                horizon: self.color(),
                ground: self.color(),
                up: self.maybe(Self::triple),
            }),
            _ => BackdropModel::Image(ImageBackdropModel {
                file: "a/sky 1.hdr".into(),
                rotation: self.maybe(Self::number),
                up: self.maybe(Self::triple),
            }),
        }
    }

    fn light(&mut self) -> LightModel {
        let falloff = |rng: &mut Self| match rng.below(2) {
            0 => FalloffModel::InverseSquare,
            _ => FalloffModel::Constant,
        };
        let is = |rng: &mut Self| rng.below(2) == 0;
        let (color, intensity) = (self.maybe(Self::color), self.maybe(Self::number));
        let name = self.maybe(Self::name);
        match self.below(6) {
            0 => LightModel::Ambient(AmbientLightModel {
                color,
                intensity,
                name,
            }),
            1 => LightModel::Headlight(HeadlightLightModel {
                color,
                intensity,
                name,
            }),
            4 => LightModel::Environment(EnvironmentLightModel {
                sky: self.maybe(|rng| SkyModel {
                    zenith: rng.color(),
                    horizon: rng.color(),
                    ground: rng.color(),
                }),
                image: self.maybe(|_| "a/sky 1.hdr".into()),
                rotation: self.maybe(Self::number),
                up: self.maybe(Self::triple),
                visible: self.maybe(is),
                color,
                intensity,
                name,
            }),
            2 => LightModel::Directional(DirectionalLightModel {
                direction: self.triple(),
                angle: self.maybe(Self::number),
                color,
                intensity,
                shadows: self.maybe(is),
                name,
            }),
            3 => LightModel::Point(PointLightModel {
                position: self.triple(),
                radius: self.maybe(Self::number),
                color,
                intensity,
                falloff: self.maybe(falloff),
                shadows: self.maybe(is),
                name,
            }),
            _ => LightModel::Spot(SpotLightModel {
                position: self.triple(),
                direction: self.maybe(Self::triple),
                look_at: self.maybe(Self::triple),
                angle: self.number(),
                blend: self.maybe(Self::number),
                radius: self.maybe(Self::number),
                color,
                intensity,
                falloff: self.maybe(falloff),
                shadows: self.maybe(is),
                name,
            }),
        }
    }

    fn model(&mut self) -> Model {
        let projection = |rng: &mut Self| match rng.below(2) {
            0 => ProjectionModel::Perspective(PerspectiveProjectionModel {
                fov: rng.number(),
                aperture: rng.maybe(Self::number),
            }),
            _ => ProjectionModel::Orthographic(OrthographicProjectionModel {}),
        };
        let camera = |rng: &mut Self| match rng.below(3) {
            2 => CameraModel::Fit(FitModel {
                from: rng.maybe(Self::triple),
                up: rng.maybe(Self::triple),
                projection: rng.maybe(projection),
                margin: rng.maybe(Self::number),
            }),
            0 => CameraModel::Perspective(PerspectiveModel {
                eye: rng.triple(),
                gaze: rng.maybe(Self::triple),
                look_at: rng.maybe(Self::triple),
                up: rng.maybe(Self::triple),
                fov: rng.number(),
                aperture: rng.maybe(Self::number),
                focus: rng.maybe(Self::number),
                focus_at: rng.maybe(Self::triple),
            }),
            _ => CameraModel::Orthographic(OrthographicModel {
                eye: rng.triple(),
                gaze: rng.maybe(Self::triple),
                look_at: rng.maybe(Self::triple),
                up: rng.maybe(Self::triple),
                scale: rng.number(),
                stretch: rng.maybe(|rng| rng.below(2) == 0),
            }),
        };
        let cameras = |rng: &mut Self| {
            let names = [Self::name(rng), Self::name(rng)];
            let all = names.map(|name| (*name, camera(rng)));
            let is_one = all[0].0 == all[1].0;
            Map(all.into_iter().skip(usize::from(is_one)).collect())
        };
        const TABLES: &[&str] = &["", "atoms.csv", "a \"b\"\\ 1.0 /* c */ \n 变 🙂.ply"];
        let single = |rng: &mut Self| match rng.below(13) {
            0 => GeometryModel::Plane(Box::new(PlaneModel {
                point: rng.triple(),
                normal: rng.triple(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            1 => GeometryModel::Sphere(SphereModel {
                center: rng.triple(),
                radius: rng.number(),
                color: rng.maybe(Self::color),
                material: rng.maybe(|rng| rng.material().into()),
                rare: match (
                    rng.maybe(|rng| rng.texture().into()),
                    rng.maybe(|rng| rng.transform().into()),
                ) {
                    // Without a box, as it is read.
                    (None, None) => Rare::default(),
                    (texture, transform) => SphereRest { texture, transform }.into(),
                },
                name: rng.maybe(Self::name),
            }),
            2 => GeometryModel::Disc(Box::new(DiscModel {
                center: rng.triple(),
                normal: rng.triple(),
                radius: rng.number(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            3 => GeometryModel::Rectangle(Box::new(RectangleModel {
                corner: rng.triple(),
                edge_u: rng.triple(),
                edge_v: rng.triple(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            4 => GeometryModel::Triangle(Box::new(TriangleModel {
                a: rng.triple(),
                b: rng.triple(),
                c: rng.triple(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            5 => GeometryModel::Box(Box::new(BoxModel {
                min: rng.triple(),
                max: rng.triple(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            6 => GeometryModel::Cylinder(Box::new(CylinderModel {
                from: rng.triple(),
                to: rng.triple(),
                radius: rng.number(),
                capped: rng.maybe(|rng| rng.below(2) == 0),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            7 => GeometryModel::Cone(Box::new(ConeModel {
                from: rng.triple(),
                to: rng.triple(),
                radius: rng.number(),
                top_radius: rng.maybe(Self::number),
                capped: rng.maybe(|rng| rng.below(2) == 0),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            8 => GeometryModel::Capsule(Box::new(CapsuleModel {
                from: rng.triple(),
                to: rng.triple(),
                radius: rng.number(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            9 => GeometryModel::Ellipsoid(Box::new(EllipsoidModel {
                center: rng.triple(),
                axes: (0..3).map(|_| rng.triple()).collect(),
                color: rng.maybe(Self::color),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            10 => GeometryModel::Cylinders(Box::new(CylindersModel {
                file: TABLES[rng.below(TABLES.len())].into(),
                columns: rng.maybe(|rng| rng.list(|rng| TABLES[rng.below(TABLES.len())].into())),
                array: rng.maybe(|rng| TABLES[rng.below(TABLES.len())].into()),
                radius: rng.maybe(Self::number),
                capped: rng.maybe(|rng| rng.below(2) == 0),
                color: rng.maybe(Self::color),
                color_by: rng.maybe(Self::color_by),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            12 => GeometryModel::Instances(Box::new(InstancesModel {
                of: rng.one(TABLES).into(),
                transforms: Some(rng.list(Self::transform)),
                file: None,
                columns: None,
                array: None,
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            11 => GeometryModel::Mesh(Box::new(MeshModel {
                file: rng.maybe(|rng| rng.one(TABLES).into()),
                vertices: rng.maybe(|rng| rng.list(Self::triple)),
                triangles: rng.maybe(|rng| rng.list(|rng| [(); 3].map(|()| rng.side()))),
                smooth: rng.maybe(|rng| rng.below(2) == 0),
                color: rng.maybe(Self::color),
                color_by: rng.maybe(Self::color_by),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
            _ => GeometryModel::Spheres(Box::new(SpheresModel {
                file: TABLES[rng.below(TABLES.len())].into(),
                columns: rng.maybe(|rng| rng.list(|rng| TABLES[rng.below(TABLES.len())].into())),
                array: rng.maybe(|rng| TABLES[rng.below(TABLES.len())].into()),
                radius: rng.maybe(Self::number),
                color: rng.maybe(Self::color),
                color_by: rng.maybe(Self::color_by),
                texture: rng.maybe(|rng| rng.texture().into()),
                material: rng.maybe(|rng| rng.material().into()),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })),
        };
        let group = |rng: &mut Self, inside: &dyn Fn(&mut Self) -> GeometryModel| {
            GeometryModel::Group(GroupModel {
                geometries: (0..rng.below(3)).map(|_| inside(rng)).collect(),
                transform: rng.maybe(|rng| rng.transform().into()),
                name: rng.maybe(Self::name),
            })
        };
        // Of any geometries: whether they are solids is a question of their values.
        let solid = |rng: &mut Self, inside: &dyn Fn(&mut Self) -> GeometryModel| {
            let of: Vec<_> = (0..rng.below(3)).map(|_| inside(rng)).collect();
            let color = rng.maybe(Self::color);
            let material = rng.maybe(|rng| rng.material().into());
            let transform = rng.maybe(|rng| rng.transform().into());
            let name = rng.maybe(Self::name);
            match rng.below(3) {
                0 => GeometryModel::Union(Box::new(UnionModel {
                    of,
                    color,
                    material,
                    transform,
                    name,
                })),
                1 => GeometryModel::Intersection(Box::new(IntersectionModel {
                    of,
                    color,
                    material,
                    transform,
                    name,
                })),
                _ => GeometryModel::Difference(Box::new(DifferenceModel {
                    of: Box::new(inside(rng)),
                    minus: of,
                    color,
                    material,
                    transform,
                    name,
                })),
            }
        };
        let geometry = |rng: &mut Self| match rng.below(14) {
            2 => solid(rng, &single),
            3 => group(rng, &|rng| solid(rng, &|rng| solid(rng, &single))),

            0 => group(rng, &|rng| group(rng, &single)),
            1 => group(rng, &single),
            _ => single(rng),
        };
        const SCHEMAS: &[&str] = &[
            "",
            "https://example.org/a.json",
            "a \"b\" \\ 1.0 /* c */ \n\t\u{1} 变 🙂",
        ];
        const UNKNOWN: &[&str] = &["", "a \"b\" \\ 1.0 // \n\t\r\u{7f} 变 🙂"];
        let warning = |rng: &mut Self| match rng.below(3) {
            0 => WarningName::Unknown(UNKNOWN[rng.below(UNKNOWN.len())].into()),
            _ => WarningName::Known(Code::WARNINGS[rng.below(Code::WARNINGS.len())]),
        };
        Model {
            schema: self.maybe(|rng| SCHEMAS[rng.below(SCHEMAS.len())].to_owned()),
            version: self.maybe(Self::side),
            image: self.maybe(|rng| ImageModel {
                width: rng.maybe(Self::side),
                height: rng.maybe(Self::side),
                samples: rng.maybe(Self::side),
                exposure: rng.maybe(Self::number),
                tone_mapping: rng.maybe(|rng| match rng.below(2) {
                    0 => ToneMappingModel::Clip,
                    _ => ToneMappingModel::Neutral,
                }),
            }),
            camera: self.maybe(camera),
            cameras: self.maybe(cameras),
            background: self.maybe(Self::color),
            backdrop: self.maybe(Self::backdrop),
            lights: self.maybe(|rng| (0..rng.below(4)).map(|_| rng.light()).collect()),
            materials: self.maybe(|rng| {
                let name = *rng.name();
                Map(vec![(name, rng.material())])
            }),
            lighting: self.maybe(|rng| {
                let max_depth = rng.maybe(Self::side);
                match rng.below(2) {
                    0 => LightingModel::Direct(DirectModel { max_depth }),
                    _ => LightingModel::Path(PathModel {
                        max_depth,
                        samples: rng.maybe(Self::side),
                        diffuse_depth: rng.maybe(Self::side),
                        caustics: rng.maybe(|rng| rng.below(2) == 0),
                        clamp: rng.maybe(Self::number),
                        noise: rng.maybe(Self::number),
                        seed: rng.maybe(Self::side),
                        filter: rng.maybe(|rng| match rng.below(2) {
                            0 => FilterModel::Box(BoxFilterModel {}),
                            _ => FilterModel::Gaussian(GaussianFilterModel {
                                sigma: rng.maybe(Self::number),
                            }),
                        }),
                    }),
                }
            }),
            outlines: self.maybe(|rng| OutlinesModel {
                width: rng.maybe(Self::number),
                color: rng.maybe(Self::color),
                depth: rng.maybe(Self::number),
                creases: rng.maybe(Self::number),
            }),
            geometries: (0..self.below(4)).map(|_| geometry(self)).collect(),
            animation: self.maybe(|rng| rng.animation().into()),
            allow: self.maybe(|rng| (0..rng.below(4)).map(|_| warning(rng)).collect()),
        }
    }
}

/// Writes a model and reads it again: every number keeps all its bits, as `Debug` shows.
fn through(model: &Model, syntax: Syntax) -> (Model, String) {
    let text = convert(model.clone(), syntax).text;
    let read = oracle::model(&text, syntax);
    let read = read.unwrap_or_else(|fault| panic!("{fault:?} in\n{text}"));
    let mut expected = model.clone();
    if syntax == Syntax::Ron {
        expected.schema = None;
    }
    assert_eq!(format!("{read:?}"), format!("{expected:?}"), "in\n{text}");
    let tree = parse(&text, syntax);
    assert_eq!(print::format(&text, &tree), text, "not in the one layout");
    (read, text)
}

#[test]
fn every_value_survives_there_and_back() {
    let mut rng = Rng(0x9e37_79b9_7f4a_7c15);
    for _ in 0..cases(CASES) {
        let model = rng.model();
        let (_, json) = through(&model, Syntax::Json);
        let (ron_model, ron) = through(&model, Syntax::Ron);
        let (back, without_schema) = through(&ron_model, Syntax::Json);
        assert!(model.schema.is_some() || json == without_schema);
        let (_, again) = through(&back, Syntax::Ron);
        assert_eq!(again, ron);
    }
}

#[test]
fn dropped_values_are_reported() {
    let text = "{\"$schema\": \"x\", \"camera\": {\"Orthographic\": {\"eye\": [0, 0, 0], \
                \"scale\": 1}}, \"geometries\": []}";
    let model = oracle::model(text, Syntax::Json).unwrap();
    let json = convert(model.clone(), Syntax::Json);
    assert!(json.dropped.is_empty() && json.text.contains("$schema"));
    let ron = convert(model, Syntax::Ron);
    assert_eq!(ron.dropped, ["`$schema`: RON does not support it"]);
    let text = "(camera: Orthographic(eye: (0, 0, 0), scale: 1), geometries: []) // a\n// b";
    let lost = LostComments::of(text, &parse(text, Syntax::Ron));
    assert_eq!(lost, Some(LostComments { count: 2, line: 1 }));
}

#[test]
fn time_is_linear() {
    let mut rng = Rng(77);
    let mut model = rng.model();
    model.geometries = (0..100_000)
        .map(|_| {
            GeometryModel::Sphere(SphereModel {
                center: rng.triple(),
                radius: rng.number(),
                color: Some(rng.color()),
                material: None,
                rare: Rare::default(),
                name: rng.maybe(Rng::name),
            })
        })
        .collect();
    for syntax in Syntax::ALL {
        let start = Instant::now();
        let text = convert(model.clone(), *syntax).text;
        let time = start.elapsed();
        eprintln!("{syntax:?}: {} bytes, {time:?}", text.len());
        assert!(time < Duration::from_secs(20));
    }
}
