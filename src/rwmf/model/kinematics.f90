!> Kinematics of one wall on one side of its motion, with the derivatives for tangents. They come
!> from the loop of `rwmf_model_lanes` with a single lane.
module rwmf_model_kinematics
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: cosine, lane_motion_t, link_coefficients, move_wall, sine, &
      tilt_link, wall_coefficients
   implicit none
   private

   public :: geometry_t, kinematics_t
   public :: geometry_of, kinematics_of, displacement_of, wall_row, put_wall_side, link_row

   !> Shape of the wall and position of its link.
   type :: geometry_t
      real(wp) :: sin_alpha = 0
      !! sine of the slenderness [-]
      real(wp) :: cos_alpha = 1
      !! cosine of the slenderness [-]
      real(wp) :: link = 0
      !! length of the link over R [-]; 0: infinitely long
      real(wp) :: sine_wall = 0
      !! sin(alpha) for a rocking wall, 0 for a hinged one [-]
      real(wp) :: sine_link(-1:1) = 0
      !! values by side for the link's displacement [-]. The value is sin(alpha) with the link at
      !! the top corner above the lifting corner, and 0 with the link above the pivot.
      real(wp) :: sine_lever(-1:1) = 0
      !! values by side for the arm of the link's force [-]
      real(wp) :: tilt(-1:1) = 1
      !! values by side; +1 where the tilt of the link pushes the frame away, -1 where it pulls the
      !! frame back
   end type geometry_t

   !> Kinematic values at one rotation, all [-].
   type :: kinematics_t
      real(wp) :: half_sine = 0
      !! sin(phi/2)
      real(wp) :: half_cosine = 1
      !! cos(phi/2)
      real(wp) :: s = 0
      !! arm of gravity over R
      real(wp) :: c = 0
      !! arm of the ground's inertia force over R
      real(wp) :: u = 0
      !! displacement of the frame over R
      real(wp) :: j = 1
      !! du/dphi
      real(wp) :: k = 0
      !! dj/dphi
      real(wp) :: k_1 = 0
      !! dk/dphi
      real(wp) :: lever = 1
      !! arm of the link's force over R
      real(wp) :: lever_1 = 0
      !! derivative of the lever with respect to phi
      real(wp) :: rise = 0
      !! rise of the link's end at the wall, over R
   end type kinematics_t

contains

   !> Geometry of a wall in one of three formulations. `exact` keeps the link at the left top
   !> corner; its displacement for theta < 0 is u_s = 2h sin(theta). `symmetric` has the link above
   !> the lifting corner on both sides. `published` combines that displacement, Eq. (4), with the
   !> arm of the left corner, Eq. (10).
   pure type(geometry_t) function geometry_of(alpha, formulation, is_rocking, link) result(geometry)
      real(wp), intent(in) :: alpha
      !! slenderness [rad]
      character(*), intent(in) :: formulation
      !! 'exact', 'symmetric' or 'published'
      logical, intent(in) :: is_rocking
      !! rocking on its corners; if false, hinged in the middle, with the link on its centre line
      real(wp), intent(in) :: link
      !! length of the link over R [-]; 0: infinitely long

      geometry%sin_alpha = sin(alpha)
      geometry%cos_alpha = cos(alpha)
      geometry%link = link
      if (.not. is_rocking) return
      geometry%sine_wall = geometry%sin_alpha
      geometry%sine_link = geometry%sin_alpha
      geometry%sine_lever = geometry%sin_alpha
      if (formulation /= 'symmetric') geometry%sine_lever(-1) = 0
      if (formulation /= 'exact') return
      geometry%sine_link(-1) = 0
      geometry%tilt(-1) = -1
   end function geometry_of

   !> Coefficients of `move_wall` on a side.
   pure function wall_row(geometry, side, R, inertia, g) result(row)
      type(geometry_t), intent(in) :: geometry
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp), intent(in) :: inertia
      !! inertia about the pivot over m_w R**2 [-]
      real(wp), intent(in) :: g
      !! [m/s2]
      real(wp) :: row(1, wall_coefficients)

      row(1, :) = [real(side, wp), 1/R, geometry%cos_alpha, geometry%sine_wall, &
         geometry%sine_link(side), geometry%sine_lever(side), inertia, g/R]
   end function wall_row

   !> Set the coefficients of `move_wall` that depend on the side.
   pure subroutine put_wall_side(geometry, side, row)
      type(geometry_t), intent(in) :: geometry
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(inout) :: row(1, wall_coefficients)
      !! coefficients of `move_wall`

      row(1, 1) = side
      row(1, 5) = geometry%sine_link(side)
      row(1, 6) = geometry%sine_lever(side)
   end subroutine put_wall_side

   !> Coefficients of `tilt_link` on a side.
   pure function link_row(geometry, side) result(row)
      type(geometry_t), intent(in) :: geometry
      !! with a link of finite length
      integer, intent(in) :: side
      !! +1 or -1
      real(wp) :: row(1, link_coefficients)

      row(1, :) = [geometry%link, geometry%tilt(side), 4*geometry%cos_alpha, &
         4*geometry%sine_link(side)]
   end function link_row

   !> Kinematics at the rotation phi towards a side.
   pure type(kinematics_t) function kinematics_of(geometry, side, phi) result(kin)
      type(geometry_t), intent(in) :: geometry
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]
      type(lane_motion_t) :: motion
      real(wp) :: j, k
      !! values without the tilt of the link
      real(wp) :: root, tilt_1, tilt_2

      motion%ground = 0
      call move_wall(wall_row(geometry, side, 1.0_wp, 0.0_wp, 0.0_wp), [side*phi], [0.0_wp], motion)
      j = motion%j(1)
      k = motion%k(1)
      kin%rise = 4*motion%half_sine(1)*(geometry%sine_link(side)*motion%half_cosine(1) &
         - geometry%cos_alpha*motion%half_sine(1))
      if (geometry%link > 0) call tilt_link(link_row(geometry, side), motion)
      kin%half_sine = motion%half_sine(1)
      kin%half_cosine = motion%half_cosine(1)
      kin%s = motion%s(1)
      kin%c = motion%c(1)
      kin%u = motion%u(1)
      kin%j = motion%j(1)
      kin%k = motion%k(1)
      kin%lever = motion%lever(1)
      kin%k_1 = -j
      kin%lever_1 = 2*geometry%sine_lever(side) - 4*kin%half_sine*(geometry%sine_lever(side) &
         *kin%half_sine + geometry%cos_alpha*kin%half_cosine)
      if (geometry%link <= 0) return
      ! derivative of root*tilt'' = k**2 - rise*j + tilt'**2
      root = sqrt(geometry%link**2 - kin%rise**2)
      tilt_1 = geometry%tilt(side)*(kin%j - j)
      tilt_2 = geometry%tilt(side)*(kin%k - k)
      kin%k_1 = kin%k_1 + geometry%tilt(side)*(3*(tilt_1*tilt_2 - k*j) - kin%rise*k)/root
      kin%lever_1 = kin%k
   end function kinematics_of

   !> Displacement of the frame over R, with the same digits as `kinematics_of`. If no link of
   !> finite length tilts, only the displacement is computed.
   pure real(wp) function displacement_of(geometry, side, phi) result(u)
      type(geometry_t), intent(in) :: geometry
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! [rad]
      type(kinematics_t) :: kin
      real(wp) :: x, y

      if (geometry%link > 0) then
         kin = kinematics_of(geometry, side, phi)
         u = kin%u
      else
         x = sine(0.5_wp*phi)
         y = cosine(0.5_wp*phi)
         u = 2*(geometry%sine_link(side)*(2*x*x) + geometry%cos_alpha*(2*x*y))
      end if
   end function displacement_of

end module rwmf_model_kinematics
