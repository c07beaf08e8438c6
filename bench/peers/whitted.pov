// Whitted's "Spheres and Checkerboard" of 1979 for POV-Ray 3.7; the numbers of scenes/whitted.toml (HOLLOW=1, a glass
// shell of inner radius 0.96) and of bench/scenes/whitted_solid.toml (HOLLOW=0). Right-handed, y up.
#version 3.7;
#ifndef (HOLLOW) #declare HOLLOW = 0; #end
global_settings { assumed_gamma 1.0 max_trace_level 10 }
camera {
  location <8,2,-4> up y right -x*image_width/image_height
  // A vertical field of view of 60 degrees; POV-Ray wants the horizontal one.
  angle 2*degrees(atan(tan(radians(30))*image_width/image_height)) look_at <4,2.3,-4>
}
background { rgb <0.34,0.55,0.85> }
light_source { <14,16,-14> rgb 1 }
polygon {
  5, <-16,0,-20>, <16,0,-20>, <16,0,12>, <-16,0,12>, <-16,0,-20>
  pigment { checker rgb <0.80,0.12,0.05>, rgb <0.90,0.75,0.06> translate -0.5*y }
  finish { ambient 0.25 diffuse 0.75 }
}
#declare Glass = material {
  texture {
    pigment { rgbf <1,1,1,0.95> }
    finish { ambient 0 diffuse 0.02 specular 0.6 roughness 0.002 reflection { 0,1 fresnel on } conserve_energy }
  }
  interior { ior 1.5 }
}
#if (HOLLOW)
difference { sphere { <4,2.3,-4>, 1 } sphere { <4,2.3,-4>, 0.96 } material { Glass } }
#else
sphere { <4,2.3,-4>, 1 material { Glass } }
#end
sphere {
  <2,1.5,-2.5>, 1
  pigment { rgb <0.7,0.7,0.7> }
  finish { ambient 0.05 diffuse 0.15 specular 0.6 roughness 0.01 reflection 0.8 }
}
