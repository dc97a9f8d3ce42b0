!> Storeys that yield one by one: the spring of each, which branch it is on, and what that means for
!> the shear, the energy and what stays displaced.
!>
!> The displacement d_i = u_i - u_(i-1) of a storey is no function of the rotation alone. So the end
!> of a branch is looked for in the states (`simulation/events`), storey by storey: elastic branches
!> end at a known d_i, one that yields where d_i' changes its sign.
module rwmf_model_effects_storeys_yielding_storeys
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t, floors_t, renew_coefficients
   use rwmf_model_floor_motion, only: storey_motion
   use rwmf_model_history_row, only: history_row_t, put
   use rwmf_model_hysteresis_bilinear, only: is_yielding, new_spring, pass_limit, reset_spring, &
      spring_force, spring_limits, spring_plastic, spring_power, spring_tangent, turn_spring
   use rwmf_model_hysteresis_bouc_wen, only: follow_signs, kept_part, new_hysteresis
   use rwmf_model_hysteresis_spring_set, only: is_elastic_plastic, storey_strengths
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: choose_storey_springs, storeys_plastic_power, start_storeys, settle_storeys
   public :: follow_storeys
   public :: branch_limits, loading_direction_of, pass_storey_limit, turn_storey
   public :: stands_still, side_beyond_zero, hysteretic_states, stop_at_zero
   public :: put_shears, storey_residuals

contains

   !> A spring for each storey of the frame.
   subroutine choose_storey_springs(case, equation)
      type(case_t), intent(in) :: case
      !! with `&yielding storey_u_y`
      type(equation_t), intent(inout) :: equation
      !! with its floors

      associate (floors => equation%floors)
         floors%yields = .true.
         if (is_elastic_plastic(case%yielding)) then
            floors%springs = new_spring(floors%k, floors%k*storey_strengths(case), &
               case%yielding%hardening)
            allocate (floors%offset(floors%n))
            call follow_storeys(equation)
         else
            call choose_laws(case, floors)
         end if
      end associate
   end subroutine choose_storey_springs

   !> Smooth hysteresis of each storey; the states of all stand behind the velocities of the floors.
   subroutine choose_laws(case, floors)
      type(case_t), intent(in) :: case
      type(floors_t), intent(inout) :: floors
      real(wp) :: u_y(floors%n)
      integer :: i

      u_y = storey_strengths(case)
      allocate (floors%laws(floors%n))
      do i = 1, floors%n
         floors%laws(i) = new_hysteresis(case%yielding, u_y(i), floors%k(i))
         floors%laws(i)%place = floors%first + 2*floors%below - 1 + i
      end do
      floors%slope = case%yielding%hardening*floors%k
   end subroutine choose_laws

   !> Straight lines of the branches that are in force; to be called when one has changed.
   pure subroutine follow_storeys(equation)
      type(equation_t), intent(inout) :: equation

      equation%floors%slope = spring_tangent(equation%floors%springs)
      equation%floors%offset = spring_force(equation%floors%springs, 0.0_wp)
      call renew_coefficients(equation)
   end subroutine follow_storeys

   !> Storeys that have not moved before, at an initial state: loaded once from zero and let go.
   subroutine start_storeys(equation, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)
      real(wp) :: low
      real(wp) :: high
      integer :: i

      if (allocated(equation%floors%laws)) then
         equation%floors%laws%loading_direction = 0
         return
      end if
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
   end subroutine start_storeys

   !> Storeys that yield against their motion unload: an impact has turned it, or the state has come
   !> to a turn within round-off. Smooth ones take over the signs of their motion.
   subroutine settle_storeys(equation, y)
      type(equation_t), intent(inout) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)
      integer :: i

      call storey_motion(equation, y, d, d_dot)
      if (allocated(equation%floors%laws)) then
         do i = 1, equation%floors%n
            associate (law => equation%floors%laws(i))
               if (abs(d_dot(i)) > 0) law%loading_direction = int(sign(1.0_wp, d_dot(i)))
               call follow_signs(law, law%loading_direction, y(law%place))
            end associate
         end do
         call renew_coefficients(equation)
         return
      end if
      do i = 1, equation%floors%n
         if (loading_direction_of(equation, i)*d_dot(i) < 0) call &
            turn_spring(equation%floors%springs(i), d(i))
      end do
      call follow_storeys(equation)
   end subroutine settle_storeys

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

   !> Sign that d_i' must keep on the branch in force, or in the piece of a smooth law; 0 on an
   !> elastic branch.
   pure integer function loading_direction_of(equation, storey) result(loading_direction)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey

      if (allocated(equation%floors%laws)) then
         loading_direction = equation%floors%laws(storey)%loading_direction
         return
      end if
      loading_direction = 0
      associate (spring => equation%floors%springs(storey))
         if (is_yielding(spring)) loading_direction = int(sign(1.0_wp, spring_power(spring, &
            1.0_wp)))
      end associate
   end function loading_direction_of

   !> Has a smooth storey not moved yet, so that it has no course?
   pure logical function stands_still(equation, storey)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey

      stands_still = .false.
      if (allocated(equation%floors%laws)) stands_still = &
         equation%floors%laws(storey)%loading_direction == 0
   end function stands_still

   !> Sign of the hysteretic state of a smooth storey beyond zero, where it can pass zero in the
   !> piece in force; else 0.
   pure integer function side_beyond_zero(equation, storey) result(side)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey

      side = 0
      if (.not. allocated(equation%floors%laws)) return
      associate (law => equation%floors%laws(storey))
         if (law%sense /= law%loading_direction) side = law%loading_direction
      end associate
   end function side_beyond_zero

   !> Hysteretic states of smooth storeys; zero of others [-].
   pure function hysteretic_states(equation, y) result(z)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: z(equation%floors%n)

      z = 0
      if (allocated(equation%floors%laws)) z = y(equation%floors%laws%place)
   end function hysteretic_states

   !> The hysteretic force of a smooth storey passes zero, to the last bit.
   pure subroutine stop_at_zero(equation, storey, y)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey
      real(wp), intent(inout) :: y(:)
      !! (states)

      y(equation%floors%laws(storey)%place) = 0
   end subroutine stop_at_zero

   !> A storey comes to a limit of its branch.
   pure subroutine pass_storey_limit(equation, storey, is_rising)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: storey
      logical, intent(in) :: is_rising
      !! d_i grows

      call pass_limit(equation%floors%springs(storey), is_rising)
      call follow_storeys(equation)
   end subroutine pass_storey_limit

   !> A storey turns back, or begins to move: what yielded unloads.
   subroutine turn_storey(equation, storey, is_rising, y)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: storey
      logical, intent(in) :: is_rising
      !! d_i grows from here on
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      if (allocated(equation%floors%laws)) then
         equation%floors%laws(storey)%loading_direction = merge(1, -1, is_rising)
         return
      end if
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
      if (allocated(equation%floors%laws)) then
         associate (laws => equation%floors%laws)
            power = sum(laws%force_at_z1*y(laws%place)*d_dot*(1 - kept_part(laws, y(laws%place))))
         end associate
      else
         power = sum(spring_power(equation%floors%springs, d_dot))
      end if
   end function storeys_plastic_power

   !> Columns of the history: shears of the columns of each storey, without dampers, over the mass
   !> that the case's are over times g [-].
   subroutine put_shears(row, equation, y)
      type(history_row_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      !! with storeys that yield one by one
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: shears(equation%floors%n)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      if (allocated(equation%floors%laws)) then
         associate (laws => equation%floors%laws)
            shears = equation%floors%slope*d + laws%force_at_z1*y(laws%place)
         end associate
      else
         shears = spring_force(equation%floors%springs, d)
      end if
      shears = shears*(equation%floors%unit/equation%p%g)
      call put(row, 'storey_{i}_shear_over_m_w_g', shears)
   end subroutine put_shears

   !> Displacement of each storey that elastic unloading to no shear would leave [m].
   function storey_residuals(equation, y) result(residuals)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: residuals(equation%floors%n)
      real(wp) :: d(equation%floors%n)
      real(wp) :: d_dot(equation%floors%n)

      call storey_motion(equation, y, d, d_dot)
      if (allocated(equation%floors%laws)) then
         associate (laws => equation%floors%laws)
            residuals = (1 - laws%hardening)*(d - laws%u_y*y(laws%place))
         end associate
      else
         residuals = spring_plastic(equation%floors%springs, d)
      end if
   end function storey_residuals

end module rwmf_model_effects_storeys_yielding_storeys
