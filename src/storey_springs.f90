!> Storeys that yield one by one: the spring of each, which branch it is on, and what that means for
!> the shear, the energy and what stays displaced.
!>
!> The displacement d_i = u_i - u_(i-1) of a storey is no function of the rotation alone. So the end
!> of a branch is looked for in the states (`storey_search.f90`), storey by storey: an elastic branch
!> ends at a known d_i, one that yields where d_i' changes its sign.
module rwmf_storey_springs
   use rwmf_case, only: case_t
   use rwmf_kinds, only: wp
   use rwmf_memory, only: storey_strengths
   use rwmf_scene, only: equation_t
   use rwmf_spring, only: is_yielding, new_spring, pass_limit, reset_spring, spring_force, &
      spring_limits, spring_plastic, spring_power, spring_tangent, turn_spring
   use rwmf_storeys, only: fill_rows, floor_motion
   implicit none
   private

   public :: choose_storey_springs, storeys_plastic_power, begin_storeys, settle_storeys
   public :: follow_storeys
   public :: storey_motion, branch_limits, course_of, pass_storey_limit, turn_storey
   public :: shear_columns, shear_values, storey_residuals

contains

   !> A spring for each storey of the frame.
   subroutine choose_storey_springs(case, equation)
      type(case_t), intent(in) :: case
      !! with `&yielding storey_u_y`
      type(equation_t), intent(inout) :: equation
      !! with its floors

      associate (floors => equation%floors)
         floors%yields = .true.
         floors%u_y = storey_strengths(case)
         floors%springs = new_spring(floors%k, floors%k*floors%u_y, case%yielding%hardening)
         allocate (floors%offset(floors%n))
      end associate
      call follow_storeys(equation)
   end subroutine choose_storey_springs

   !> Straight lines of the branches that are in force; to be called when one has changed.
   pure subroutine follow_storeys(equation)
      type(equation_t), intent(inout) :: equation

      equation%floors%slope = spring_tangent(equation%floors%springs)
      equation%floors%offset = spring_force(equation%floors%springs, 0.0_wp)
      call fill_rows(equation%floors)
   end subroutine follow_storeys

   !> Storeys that have not moved before, at an initial state: loaded once from zero and let go.
   subroutine begin_storeys(equation, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)
      real(wp) :: low
      real(wp) :: high
      integer :: i

      call storey_motion(equation, y, d, d_dot)
      do i = 1, equation%floors%n
         associate (spring => equation%floors%springs(i))
            call reset_spring(spring)
            call spring_limits(spring, low, high)
            if (d(i) < low .or. d(i) > high) call pass_limit(spring, d(i) > high)
            call turn_spring(spring, d(i))
         end associate
      end do
      call follow_storeys(equation)
   end subroutine begin_storeys

   !> Storeys that yield against their motion unload: an impact has turned it, or the state has come
   !> to a turn within round-off.
   subroutine settle_storeys(equation, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)
      integer :: i

      call storey_motion(equation, y, d, d_dot)
      do i = 1, equation%floors%n
         if (course_of(equation, i)*d_dot(i) < 0) call turn_spring(equation%floors%springs(i), d(i))
      end do
      call follow_storeys(equation)
   end subroutine settle_storeys

   !> What the storeys are displaced by, and how fast.
   subroutine storey_motion(equation, y, d, d_dot)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: d(:)
      !! (n) u_i - u_(i-1) [m]
      real(wp), intent(out) :: d_dot(:)
      !! (n) [m/s]
      real(wp) :: u(0:size(d))
      real(wp) :: v(size(d))
      integer :: n

      n = size(d)
      call floor_motion(equation, y, u, v)
      d = u(1:) - u(:n - 1)
      d_dot = v
      d_dot(2:) = v(2:) - v(:n - 1)
   end subroutine storey_motion

   !> Displacements between which the branch of a storey holds.
   pure subroutine branch_limits(equation, storey, low, high)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey
      real(wp), intent(out) :: low
      !! [m]
      real(wp), intent(out) :: high
      !! [m]

      call spring_limits(equation%floors%springs(storey), low, high)
   end subroutine branch_limits

   !> Sign that d_i' must keep on the branch in force; 0 on an elastic one.
   pure integer function course_of(equation, storey) result(course)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey

      course = 0
      associate (spring => equation%floors%springs(storey))
         if (is_yielding(spring)) course = int(sign(1.0_wp, spring_power(spring, 1.0_wp)))
      end associate
   end function course_of

   !> A storey comes to a limit of its branch.
   pure subroutine pass_storey_limit(equation, storey, is_rising)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: storey
      logical, intent(in) :: is_rising
      !! d_i grows

      call pass_limit(equation%floors%springs(storey), is_rising)
      call follow_storeys(equation)
   end subroutine pass_storey_limit

   !> A storey turns back: what yielded unloads.
   subroutine turn_storey(equation, storey, y)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: storey
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      call turn_spring(equation%floors%springs(storey), d(storey))
      call follow_storeys(equation)
   end subroutine turn_storey

   !> Power that the storeys dissipate by yielding [W/kg].
   real(wp) function storeys_plastic_power(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      power = sum(spring_power(equation%floors%springs, d_dot))
   end function storeys_plastic_power

   !> Columns of the history with the shears of storeys that yield; none for others.
   pure function shear_columns(equation) result(names)
      type(equation_t), intent(in) :: equation
      character(32), allocatable :: names(:)
      integer :: i

      allocate (names(0))
      if (.not. equation%floors%yields) return
      deallocate (names)
      allocate (names(equation%floors%n))
      do i = 1, size(names)
         write (names(i), '(a, i0, a)') 'storey_', i, '_shear_over_m_w_g'
      end do
   end function shear_columns

   !> Shears of the columns of each storey, without dampers, over the mass that the case's are over
   !> times g [-].
   function shear_values(equation, y) result(shears)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: shears(equation%floors%n)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      shears = spring_force(equation%floors%springs, d)*(equation%floors%unit/equation%p%g)
   end function shear_values

   !> Displacement of each storey that elastic unloading to no shear would leave [m].
   function storey_residuals(equation, y) result(residuals)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: residuals(equation%floors%n)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      residuals = spring_plastic(equation%floors%springs, d)
   end function storey_residuals

end module rwmf_storey_springs
