!> Storeys that yield one by one: the spring of each, its active branch, and the resulting shear,
!> energy and residual displacement.
!>
!> The displacement d_i = u_i - u_(i-1) of a storey is not a function of the rotation alone. So the
!> end of a branch is located in the states (`simulation/events`), storey by storey. An elastic
!> branch ends at a known d_i, a yielding one where d_i' changes its sign.
module rwmf_model_floors_yielding_storeys
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: discrete_state_t, equation_t, frame_mass, model_t, &
      renew_coefficients
   use rwmf_model_floor_motion, only: follows_roof, storey_motion
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_hysteresis_bouc_wen, only: follow_signs
   use rwmf_model_hysteresis_bouc_wen_backbone, only: unloaded_displacement
   use rwmf_model_hysteresis_spring_laws, only: branch_word, load_spring, loading_direction, &
      new_branch, pass_limit, spring_force, spring_limits, spring_loss, spring_residual, &
      turn_spring
   use rwmf_problem_quantity_table, only: id
   implicit none
   private

   public :: storeys_loss, start_storeys, settle_storeys
   public :: branch_limits, loading_direction_of, pass_storey_limit, turn_storey
   public :: stands_still, side_beyond_zero, hysteretic_states, stop_at_zero
   public :: put_shears, storey_residuals, storey_word, is_softening

contains

   !> Initialise storeys that have not moved: load them slowly from zero to the initial state, then
   !> release them.
   subroutine start_storeys(model, state, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(model%floors%n_storeys)
      real(wp) :: d_dot(model%floors%n_storeys)
      integer :: i

      if (.not. model%floors%yields) return
      if (allocated(state%storey_signs)) then
         state%storey_signs%loading_direction = 0
         return
      end if
      call storey_motion(model, state%side, y, d, d_dot)
      do i = 1, model%floors%n_storeys
         associate (spring => model%floors%springs(i), branch => state%storey_branches(i))
            branch = new_branch(spring)
            call load_spring(spring, branch, d(i))
         end associate
      end do
      call renew_storeys(model, state, huge(i))
   end subroutine start_storeys

   !> Unload yielding storeys that move against their loading direction after an impact, or within
   !> round-off of a reversal. Smooth storeys take the signs of their motion.
   subroutine settle_storeys(model, state, y, keeps_directions)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states)
      logical, intent(in) :: keeps_directions
      !! true if the loading directions are known and rates within round-off of zero do not change
      !! them
      real(wp) :: d(model%floors%n_storeys)
      real(wp) :: d_dot(model%floors%n_storeys)
      integer :: highest
      !! number of the highest storey that unloads
      integer :: i

      if (.not. model%floors%yields) return
      highest = 0
      call storey_motion(model, state%side, y, d, d_dot)
      do i = 1, model%floors%n_storeys
         if (allocated(state%storey_signs)) then
            associate (law => model%floors%laws(i), signs => state%storey_signs(i))
               if (abs(d_dot(i)) > 0 .and. .not. keeps_directions) signs%loading_direction = &
                  int(sign(1.0_wp, d_dot(i)))
               call follow_signs(law, y(law%place), signs)
            end associate
         else if (loading_direction_of(model, state, i)*d_dot(i) < 0 .and. .not. keeps_directions) &
            then
            call turn_spring(model%floors%springs(i), state%storey_branches(i), d(i))
            highest = i
         end if
      end do
      if (highest > 0 .or. allocated(state%storey_signs)) call renew_storeys(model, state, highest)
   end subroutine settle_storeys

   !> Update the coefficients of the loops after branches of storeys have changed.
   !>
   !> Only the storey below a linked roof acts on the wall, and a smooth one acts through its state.
   !> So the cached uplift quantities remain valid unless that storey has changed its branch. The
   !> time to recompute them grows with the cube of the number of storeys.
   pure subroutine renew_storeys(model, state, highest)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: highest
      !! highest storey whose branch has changed, from the ground up
      logical :: is_known

      if (follows_roof(model)) then
         state%frame_slope = state%storey_branches(1)%slope/frame_mass(model)
         state%frame_offset = state%storey_branches(1)%offset/frame_mass(model)
      end if
      is_known = state%capacity_is_known .and. (allocated(state%storey_signs) &
         .or. highest <= model%floors%free)
      call renew_coefficients(model, state)
      state%capacity_is_known = is_known
   end subroutine renew_storeys

   !> Displacements between which the branch of a storey is valid; a smooth storey has no limits.
   pure subroutine branch_limits(equation, storey, low, high)
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: storey
      !! number of the storey, from the ground up
      real(wp), intent(out) :: low
      !! lower limit [m]
      real(wp), intent(out) :: high
      !! upper limit [m]

      low = -huge(low)
      high = huge(high)
      if (allocated(equation%floors%springs)) call spring_limits(equation%floors%springs(storey), &
         equation%state%storey_branches(storey), low, high)
   end subroutine branch_limits

   !> Sign that d_i' keeps on the active branch, or in the current piece of a smooth law; 0 on an
   !> elastic branch.
   pure integer function loading_direction_of(model, state, storey) result(direction)
      class(model_t), intent(in) :: model
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up

      if (allocated(state%storey_signs)) then
         direction = state%storey_signs(storey)%loading_direction
      else
         direction = loading_direction(model%floors%springs(storey), state%storey_branches(storey))
      end if
   end function loading_direction_of

   !> Name of the active branch of a storey, see `branch_word`.
   pure function storey_word(model, state, storey) result(word)
      class(model_t), intent(in) :: model
      !! with storeys on straight lines
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up
      character(8) :: word

      word = branch_word(model%floors%springs(storey), state%storey_branches(storey))
   end function storey_word

   !> Return whether the force of a storey falls along its active branch.
   pure logical function is_softening(state, storey)
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up

      is_softening = state%storey_branches(storey)%slope < 0
   end function is_softening

   !> Return whether a smooth storey has not moved yet, so that it has no loading direction.
   pure logical function stands_still(state, storey)
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up

      stands_still = .false.
      if (allocated(state%storey_signs)) stands_still = &
         state%storey_signs(storey)%loading_direction == 0
   end function stands_still

   !> Sign of the hysteretic state of a smooth storey after it passes zero in the current piece; 0
   !> if it cannot.
   pure integer function side_beyond_zero(state, storey) result(side)
      type(discrete_state_t), intent(in) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up

      side = 0
      if (.not. allocated(state%storey_signs)) return
      associate (signs => state%storey_signs(storey))
         if (signs%sense /= signs%loading_direction) side = signs%loading_direction
      end associate
   end function side_beyond_zero

   !> Hysteretic states of smooth storeys; zero for other storeys [-].
   pure function hysteretic_states(equation, y) result(z)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: z(equation%floors%n_storeys)

      z = 0
      if (allocated(equation%floors%laws)) z = y(equation%floors%laws%place)
   end function hysteretic_states

   !> Set the hysteretic state of a smooth storey exactly to zero where it passes zero.
   pure subroutine stop_at_zero(model, storey, y)
      type(model_t), intent(in) :: model
      integer, intent(in) :: storey
      !! number of the storey, from the ground up
      real(wp), intent(inout) :: y(:)
      !! (states)

      y(model%floors%laws(storey)%place) = 0
   end subroutine stop_at_zero

   !> Begin the next branch where a storey reaches a limit of its branch.
   pure subroutine pass_storey_limit(model, state, storey, is_rising)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up
      logical, intent(in) :: is_rising
      !! true if d_i grows

      call pass_limit(model%floors%springs(storey), state%storey_branches(storey), is_rising)
      call renew_storeys(model, state, storey)
   end subroutine pass_storey_limit

   !> Unload a storey that reverses, or set the loading direction of a smooth one.
   subroutine turn_storey(model, state, storey, is_rising, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      integer, intent(in) :: storey
      !! number of the storey, from the ground up
      logical, intent(in) :: is_rising
      !! true if d_i grows after the event
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(model%floors%n_storeys)
      real(wp) :: d_dot(model%floors%n_storeys)

      if (allocated(state%storey_signs)) then
         state%storey_signs(storey)%loading_direction = merge(1, -1, is_rising)
         return
      end if
      call storey_motion(model, state%side, y, d, d_dot)
      call turn_spring(model%floors%springs(storey), state%storey_branches(storey), d(storey))
      call renew_storeys(model, state, storey)
   end subroutine turn_storey

   !> Energy dissipated by yielding of storeys on straight lines since t = 0 [J/kg].
   real(wp) function storeys_loss(equation, y) result(loss)
      type(equation_t), intent(in) :: equation
      !! equation with storeys that yield one by one
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: d(equation%floors%n_storeys)
      real(wp) :: d_dot(equation%floors%n_storeys)

      loss = 0
      if (allocated(equation%floors%laws)) return
      call storey_motion(equation, equation%state%side, y, d, d_dot)
      loss = sum(spring_loss(equation%floors%springs, equation%state%storey_branches, d))
   end function storeys_loss

   !> Write the history columns of storey shears without dampers, over the weight of the case's
   !> reference mass [-]. A frame that follows the roof has one, over its weight.
   subroutine put_shears(row, equation, y)
      type(values_t), intent(inout) :: row
      type(equation_t), intent(in) :: equation
      !! equation with storeys that yield one by one
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: shears(equation%floors%n_storeys)
      real(wp) :: d(equation%floors%n_storeys)
      real(wp) :: d_dot(equation%floors%n_storeys)

      call storey_motion(equation, equation%state%side, y, d, d_dot)
      if (allocated(equation%floors%laws)) then
         associate (laws => equation%floors%laws)
            shears = equation%state%storey_branches%slope*d + laws%force_at_z1*y(laws%place)
         end associate
      else
         shears = spring_force(equation%floors%springs, equation%state%storey_branches, d)
      end if
      if (follows_roof(equation)) then
         call put(row, id%frame_force_over_m_s_g, shears(1)/(frame_mass(equation)*equation%p%g))
         return
      end if
      shears = equation%walls*shears*(equation%floors%unit/equation%p%g)
      call put(row, id%storey_i_shear_over_m_w_g, shears)
   end subroutine put_shears

   !> Displacement of zero shear after slow unloading, of each storey [m].
   function storey_residuals(equation, y) result(residuals)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: residuals(equation%floors%n_storeys)
      real(wp) :: d(equation%floors%n_storeys)
      real(wp) :: d_dot(equation%floors%n_storeys)

      call storey_motion(equation, equation%state%side, y, d, d_dot)
      if (allocated(equation%floors%laws)) then
         associate (laws => equation%floors%laws)
            residuals = laws%u_y*unloaded_displacement(d/laws%u_y, y(laws%place), &
               laws%hardening, laws%beta, laws%exponent)
         end associate
      else
         residuals = spring_residual(equation%floors%springs, equation%state%storey_branches, d)
      end if
   end function storey_residuals

end module rwmf_model_floors_yielding_storeys
