// The scenes of bench/scenes/implicit_*.toml for POV-Ray: z is up, one parallel light, no sampling beyond one ray a pixel.
// SHAPE: 0 heart as isosurface, 1 heart as polynomial, 2 torus as isosurface, 3 torus, 4 gyroid, 5 blob.
// GRADIENT: max_gradient of the isosurfaces. MASK: the shape white on black, without light and floor.
#version 3.7;
#ifndef (SHAPE) #declare SHAPE = 0; #end
#ifndef (GRADIENT) #declare GRADIENT = 60; #end
#ifndef (MASK) #declare MASK = 0; #end
global_settings { assumed_gamma 1 max_trace_level 8 }
camera {
  location <1.3, -3.9, 1.3> sky z up z right -x * image_width / image_height
  angle 2 * degrees(atan2(tan(radians(18)) * image_width / image_height, 1))
  look_at <0, 0, 0.05>
}
#if (MASK)
  background { rgb 0 }
  #declare Look = texture { pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }
#else
  background { rgb <0.45, 0.55, 0.65> }
  light_source { <50, -60, 80> rgb 1 parallel point_at 0 }
  plane { z, -1.4 pigment { checker rgb 0.75 rgb 0.25 } finish { ambient 0.4 diffuse 0.7 } }
  #declare Look = texture { pigment { rgb <0.75, 0.04, 0.06> } finish { ambient 0.4 diffuse 0.7 specular 0.5 roughness 0.02 } }
#end

#macro Cut(A, B) contained_by { box { A, B } } max_gradient GRADIENT accuracy 0.0001 texture { Look } #end

#switch (SHAPE)
#case (0)
  isosurface {
    function { pow(x*x + 9/4*y*y + z*z - 1, 3) - x*x*z*z*z - 9/80*y*y*z*z*z }
    Cut(<-1.3, -0.8, -1.1>, <1.3, 0.8, 1.35>)
  }
#break
#case (1)
  // (x² + a y² + z² − 1)³ − x² z³ − b y² z³, multiplied out.
  #declare a = 9/4; #declare b = 9/80;
  polynomial { 6,
    xyz(6,0,0): 1, xyz(4,2,0): 3*a, xyz(2,4,0): 3*a*a, xyz(0,6,0): a*a*a, xyz(4,0,2): 3, xyz(2,2,2): 6*a, xyz(0,4,2): 3*a*a,
    xyz(2,0,4): 3, xyz(0,2,4): 3*a, xyz(0,0,6): 1, xyz(4,0,0): -3, xyz(2,2,0): -6*a, xyz(0,4,0): -3*a*a, xyz(2,0,2): -6,
    xyz(0,2,2): -6*a, xyz(0,0,4): -3, xyz(2,0,0): 3, xyz(0,2,0): 3*a, xyz(0,0,2): 3, xyz(0,0,0): -1,
    xyz(2,0,3): -1, xyz(0,2,3): -b
    bounded_by { box { <-1.3, -0.8, -1.1>, <1.3, 0.8, 1.35> } }
    texture { Look }
  }
#break
#case (2)
  isosurface {
    function { pow(sqrt(x*x + y*y) - 1, 2) + z*z - 0.35*0.35 }
    Cut(<-1.4, -1.4, -0.4>, <1.4, 1.4, 0.4>)
  }
#break
#case (3)
  torus { 1, 0.35 rotate 90*x texture { Look } }
#break
#case (4)
  isosurface {
    function {
      max(abs(sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x)) - 0.25, 6*(sqrt(x*x + y*y + z*z) - 1.25))
    }
    Cut(<-1.3, -1.3, -1.3>, <1.3, 1.3, 1.3>)
  }
#break
#case (5)
  isosurface {
    function { sqrt(x*x + y*y + z*z) - 1 - 0.1*sin(9*x)*sin(9*y)*sin(9*z) - 0.05*sin(4*x + 3*y) }
    Cut(<-1.2, -1.2, -1.2>, <1.2, 1.2, 1.2>)
  }
#break
#end
