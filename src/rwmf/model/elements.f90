!> Vertical elements of a wall: tendons, fuses, dampers, restraints at floors and couplings between
!> walls. One type describes them all: a stroke, and the force that follows from it.
!>
!> Forces are over m_w [m/s2], positive where they act against a growing stroke. By virtual work the
!> moment is the force times the arm dx/dphi. On a branch a force is linear in the stroke, so the
!> moments of all elements with the same kind of stroke have a sum with few coefficients, computed
!> here for the loops over lanes.
module rwmf_model_elements
   use rwmf_core_kinds, only: wp
   use rwmf_model_lanes, only: axis_coefficients, chord_coefficients, line_coefficients, &
      rise_coefficients
   use rwmf_model_spring, only: branch_t
   use rwmf_model_stroke, only: along_axis, along_chord, along_line, arm_at, arm_slope_at, &
      stroke_at, stroke_t, rising
   implicit none
   private

   public :: element_t, of_cable, of_fuse, of_damper, of_coupling, of_restraint
   public :: line_of_element, element_force, element_path, tendon_strain
   public :: sum_of_forces, sum_of_moments
   public :: axis_row, chord_row, line_rows, rise_row

   integer, parameter :: of_cable = 1
   integer, parameter :: of_fuse = 2
   integer, parameter :: of_damper = 3
   integer, parameter :: of_coupling = 4
   integer, parameter :: of_restraint = 5

   !> Vertical element.
   type :: element_t
      integer :: group = of_cable
      !! group of the case that gives it, one of the numbers above
      type(stroke_t) :: stroke
      real(wp) :: offset = 0
      !! place d on the wall, to the right of its axis [m]
      real(wp) :: weight = 1
      !! number of such elements for each wall [-]
      integer :: spring = 0
      !! number of its spring with memory; 0: its force has a single line
      real(wp) :: force_0 = 0
      !! force of that line at zero stroke [m/s2]
      real(wp) :: stiffness = 0
      !! slope of that line [1/s2]
      real(wp) :: c = 0
      !! constant of its viscous damper [1/s]
      real(wp) :: force_1 = 0
      !! force of its nonlinear damper at 1 m/s [m/s2]
      real(wp) :: exponent = 1
      !! exponent of that damper [-]
      real(wp) :: length = 0
      !! length of a tendon that is strained [m]; 0: unknown
      logical :: is_signed = .false.
      !! Eq. (1) as printed: the force falls with rocking for theta < 0
   end type element_t

contains

   !> Active line of an element: force at zero stroke [m/s2] and slope [1/s2].
   pure function line_of_element(element, branches) result(line)
      type(element_t), intent(in) :: element
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      real(wp) :: line(2)

      if (element%spring > 0) then
         line = [branches(element%spring)%offset, branches(element%spring)%slope]
      else
         line = [element%force_0, element%stiffness]
      end if
   end function line_of_element

   !> Force of an element, with its dampers [m/s2].
   pure real(wp) function element_force(element, branches, side, phi, rate) result(force)
      type(element_t), intent(in) :: element
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! |theta| [rad]
      real(wp), intent(in) :: rate
      !! phi' [rad/s]
      real(wp) :: line(2), speed

      line = line_of_element(element, branches)
      force = line(1) + line(2)*merge(side, 1, element%is_signed)*stroke_at(element%stroke, side, &
         phi)
      if (.not. (element%c > 0 .or. element%force_1 > 0)) return
      speed = arm_at(element%stroke, side, phi)*rate
      force = force + element%c*speed
      if (element%force_1 > 0) force = force + element%force_1*sign(abs(speed)**element%exponent, &
         speed)
   end function element_force

   !> Strain of a tendon with a known length, that of the prestress included [-].
   pure real(wp) function tendon_strain(tendon, theta) result(strain)
      type(element_t), intent(in) :: tendon
      real(wp), intent(in) :: theta
      !! [rad]
      integer :: side

      side = merge(1, -1, theta >= 0)
      strain = (tendon%force_0/tendon%stiffness + merge(side, 1, tendon%is_signed) &
         *stroke_at(tendon%stroke, side, abs(theta)))/tendon%length
   end function tendon_strain

   !> Unit vector in which an element pulls at the wall, to the right and upward.
   pure function element_path(element, side, phi) result(path)
      type(element_t), intent(in) :: element
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! |theta| [rad]
      real(wp) :: path(2)

      associate (a => element%stroke%arm(side), z => element%stroke%height)
         select case (element%stroke%kind)
         case (along_axis)
            path = -[side*sin(phi), cos(phi)]
         case (along_line)
            path = -[side*(z*sin(phi) + 2*a*sin(phi/2)**2), a*sin(phi) + z*cos(phi)] &
               /(z + stroke_at(element%stroke, side, phi))
         case (rising)
            path = [0.0_wp, -1.0_wp]
         case default
            ! a device under the pivot stands still and upright
            path = merge(-[0.0_wp, 1.0_wp], -[side*sin(phi/2), cos(phi/2)], abs(a) <= 0)
         end select
      end associate
   end function element_path

   !> Force of the elements of some groups on a wall, to the right and upward, as a mean over all
   !> walls. Couplings between walls are internal forces [m/s2].
   pure function sum_of_forces(elements, groups, branches, side, phi, rate) result(force)
      type(element_t), intent(in) :: elements(:)
      integer, intent(in) :: groups(:)
      !! numbers of the groups
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi, rate
      !! |theta| [rad] and phi' [rad/s]
      real(wp) :: force(2)
      integer :: i

      force = 0
      do i = 1, size(elements)
         if (elements(i)%group == of_coupling .or. all(groups /= elements(i)%group)) cycle
         force = force + elements(i)%weight*element_force(elements(i), branches, side, phi, rate) &
            *element_path(elements(i), side, phi)
      end do
   end function sum_of_forces

   !> Moment of the elements of some groups about the pivot, against phi, and its derivative by phi
   !> for a wall without velocity [m2/s2].
   pure function sum_of_moments(elements, groups, branches, side, phi) result(moment)
      type(element_t), intent(in) :: elements(:)
      integer, intent(in) :: groups(:)
      !! numbers of the groups
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: phi
      !! |theta| [rad]
      real(wp) :: moment(2)
      real(wp) :: line(2), arm
      integer :: i

      moment = 0
      do i = 1, size(elements)
         associate (element => elements(i), w => elements(i)%weight)
            if (all(groups /= element%group)) cycle
            line = line_of_element(element, branches)
            if (element%is_signed) line(2) = side*line(2)
            arm = arm_at(element%stroke, side, phi)
            line(1) = line(1) + line(2)*stroke_at(element%stroke, side, phi)
            moment = moment + w*[line(1)*arm, line(2)*arm**2 + line(1)*arm_slope_at( &
               element%stroke, side, phi)]
         end associate
      end do
   end function sum_of_moments

   !> Coefficients of `add_axial` for all tendons along the wall's axis.
   pure function axis_row(elements, branches, side, R) result(row)
      type(element_t), intent(in) :: elements(:)
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp) :: row(axis_coefficients)
      real(wp) :: line(2)
      integer :: i

      row = 0
      do i = 1, size(elements)
         if (elements(i)%stroke%kind /= along_axis) cycle
         line = line_of_element(elements(i), branches)
         if (elements(i)%is_signed) line(2) = side*line(2)
         associate (a => elements(i)%stroke%arm(side))
            row = row + [line*a*[1.0_wp, a]/R**2, line*[1.0_wp, a]]
         end associate
      end do
   end function axis_row

   !> Coefficients of `add_straight_tendons` for each straight tendon.
   pure function line_rows(elements, branches, side, R) result(rows)
      type(element_t), intent(in) :: elements(:)
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp) :: rows(line_coefficients*count(elements%stroke%kind == along_line))
      integer :: i, last

      last = 0
      do i = 1, size(elements)
         if (elements(i)%stroke%kind /= along_line) cycle
         rows(last + 1:last + line_coefficients) = [line_of_element(elements(i), branches)/R**2, &
            elements(i)%stroke%height, elements(i)%stroke%arm(side)]
         last = last + line_coefficients
      end do
   end function line_rows

   !> Coefficients of `add_chords` for all devices under the base but nonlinear dampers.
   pure function chord_row(elements, branches, side, R) result(row)
      type(element_t), intent(in) :: elements(:)
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp) :: row(chord_coefficients)
      real(wp) :: line(2)
      integer :: i

      row = 0
      do i = 1, size(elements)
         if (elements(i)%stroke%kind /= along_chord) cycle
         line = line_of_element(elements(i), branches)
         associate (a => elements(i)%stroke%arm(side), c => elements(i)%c)
            row(:3) = row(:3) + [a*line(1), 2*a**2*line(2), a**2*c]/R**2
            ! a device under the pivot stands still and upright
            if (abs(a) > 0) row(4:6) = row(4:6) + [line(1), 2*a*line(2), a*c]
            if (abs(a) <= 0) row(7) = row(7) + line(1)
         end associate
      end do
   end function chord_row

   !> Coefficients of `add_rises` for all elements with vertical strokes.
   pure function rise_row(elements, branches, side, R) result(row)
      type(element_t), intent(in) :: elements(:)
      type(branch_t), allocatable, intent(in) :: branches(:)
      !! (springs) active branches
      integer, intent(in) :: side
      !! +1 or -1
      real(wp), intent(in) :: R
      !! half diagonal [m]
      real(wp) :: row(rise_coefficients)
      real(wp) :: line(2)
      integer :: i

      row = 0
      do i = 1, size(elements)
         if (elements(i)%stroke%kind /= rising) cycle
         line = line_of_element(elements(i), branches)
         associate (a => elements(i)%stroke%arm(side), z => elements(i)%stroke%height, &
            c => elements(i)%c, w => elements(i)%weight/R**2)
            ! products of x = a sin - z (1 - cos) and dx/dphi = a cos - z sin, in sin and cos of phi
            ! and 2 phi
            row = row + w*[line(1)*a - line(2)*a*z, line(2)*z**2 - line(1)*z, &
               line(2)*(a**2 - z**2)/2, line(2)*a*z, c*(a**2 + z**2)/2, c*(a**2 - z**2)/2, c*a*z]
         end associate
      end do
   end function rise_row

end module rwmf_model_elements
