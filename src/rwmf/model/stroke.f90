!> Strokes of the vertical elements of a wall: tendons, devices under the base, restraints at floors
!> and couplings between walls (docs/theory/elements.md).
!>
!> The stroke follows from phi = |theta| and from the arm a of the element's line about the pivot, a
!> = b - side*d at the offset d. It vanishes at phi = 0 on both sides. A wall on a hinge has the arm
!> -d and one side.
module rwmf_model_stroke
   use rwmf_core_kinds, only: pi, wp
   implicit none
   private

   public :: stroke_t, along_axis, along_line, along_chord, rising
   public :: stroke_at, arm_at, arm_slope_at, turning_angle, angle_of_stroke, moves

   integer, parameter :: along_axis = 1
   !! linear in phi: the tendon of Eq. (1)
   integer, parameter :: along_line = 2
   !! elongation of a straight tendon
   integer, parameter :: along_chord = 3
   !! chord of a point of the base
   integer, parameter :: rising = 4
   !! rise of a point; at height 0 also the stroke of a coupling, with the arm side*(2b + span)

   !> Stroke of an element.
   type :: stroke_t
      integer :: kind = along_chord
      !! one of the numbers above
      real(wp) :: arm(-1:1) = 0
      !! arm a at phi = 0 by side of the motion [m]
      real(wp) :: height = 0
      !! length of a straight tendon at rest, or height z of the point that rises [m]
   end type stroke_t

contains

   !> Stroke at a rotation [m].
   pure real(wp) function stroke_at(stroke, side, phi) result(x)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]
      real(wp) :: rise
      !! change of the squared length [m2]

      associate (a => stroke%arm(side), z => stroke%height, s => sin(phi/2), c => cos(phi/2))
         select case (stroke%kind)
         case (along_axis)
            x = a*phi
         case (along_line)
            rise = 4*a*(a*s**2 + z*s*c)
            x = rise/(sqrt(z**2 + rise) + z)
         case (rising)
            x = 2*s*(a*c - z*s)
         case default
            x = 2*a*s
         end select
      end associate
   end function stroke_at

   !> Arm of the element's force: derivative of the stroke by phi [m].
   pure real(wp) function arm_at(stroke, side, phi) result(arm)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]

      associate (a => stroke%arm(side), z => stroke%height, s => sin(phi/2), c => cos(phi/2))
         select case (stroke%kind)
         case (along_axis)
            arm = a
         case (along_line)
            arm = a*(2*a*s*c + z*(1 - 2*s**2))/sqrt(z**2 + 4*a*(a*s**2 + z*s*c))
         case (rising)
            arm = a*cos(phi) - z*sin(phi)
         case default
            arm = a*c
         end select
      end associate
   end function arm_at

   !> Derivative of the arm by phi [m].
   pure real(wp) function arm_slope_at(stroke, side, phi) result(slope)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]

      associate (a => stroke%arm(side), z => stroke%height)
         select case (stroke%kind)
         case (along_axis)
            slope = 0
         case (along_line)
            slope = (a*(a*cos(phi) - z*sin(phi)) - arm_at(stroke, side, phi)**2)/(z &
               + stroke_at(stroke, side, phi))
         case (rising)
            slope = -a*sin(phi) - z*cos(phi)
         case default
            slope = -a*sin(phi/2)/2
         end select
      end associate
   end function arm_slope_at

   !> Rotation at which the stroke turns though the wall goes on; the largest number if there is
   !> none before a right angle [rad].
   pure real(wp) function turning_angle(stroke, side) result(phi)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1

      phi = huge(phi)
      associate (a => stroke%arm(side), z => stroke%height)
         if (stroke%kind == rising .and. a > 0 .and. z > 0) phi = atan2(a, z)
         if (stroke%kind == along_line .and. a < 0) phi = atan2(z, -a)
      end associate
   end function turning_angle

   !> Rotation at which an element reaches a stroke between 0 and that of a right angle, before or
   !> beyond its turn [rad].
   pure real(wp) function angle_of_stroke(stroke, side, x, is_beyond) result(phi)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1, towards which the element moves
      real(wp), intent(in) :: x
      !! stroke [m]
      logical, intent(in) :: is_beyond
      !! beyond `turning_angle`
      real(wp) :: sine, shift, arm, change
      integer :: i

      associate (a => stroke%arm(side), z => stroke%height)
         select case (stroke%kind)
         case (along_axis)
            phi = x/a
            return
         case (along_line)
            ! (z + x)**2 = z**2 + 2 a**2 + 2 a sqrt(z**2 + a**2) sin(phi - atan2(a, z))
            sine = (x*(2*z + x)/(2*a) - a)/norm2([a, z])
            shift = atan2(a, z)
         case (rising)
            ! x + z = sqrt(a**2 + z**2) sin(phi + atan2(z, a))
            sine = (x + z)/norm2([a, z])
            shift = -atan2(z, a)
            if (a <= 0) shift = shift + pi
            if (a <= 0) sine = -sine
         case default
            phi = 2*asin(max(-1.0_wp, min(1.0_wp, x/(2*a))))
            return
         end select
      end associate
      phi = asin(max(-1.0_wp, min(1.0_wp, sine)))
      if (is_beyond) phi = merge(pi, -pi, phi + shift < turning_angle(stroke, side)) - phi
      phi = phi + shift
      ! restores the digits that the difference of two angles has lost
      do i = 1, 2
         arm = arm_at(stroke, side, phi)
         if (abs(arm) <= sqrt(epsilon(arm))*stroke%height) return
         change = (x - stroke_at(stroke, side, phi))/arm
         phi = phi + change
         if (abs(change) <= sqrt(epsilon(phi))*abs(phi)) return
      end do
   end function angle_of_stroke

   !> Return whether an element moves on a side.
   pure logical function moves(stroke, side)
      type(stroke_t), intent(in) :: stroke
      integer, intent(in) :: side
      !! +1 or -1

      moves = abs(stroke%arm(side)) > 0 .or. (stroke%kind == rising .and. stroke%height > 0)
   end function moves

end module rwmf_model_stroke
