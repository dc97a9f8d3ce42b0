!> Effects beyond wall, frame and cable: selection for a case, and sums over all of them.
module rwmf_model_system_contributions
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_list, only: prepare_effect
   use rwmf_model_effects_numbers, only: bending_effect, effect_count
   use rwmf_model_equation, only: contribution_t, equation_t
   use rwmf_model_scene, only: add_term, elsewhere, term_t, through_link
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: choose_contributions
   public :: state_sizes, effects_energy, effects_frame_energy, effects_frame_force

contains

   !> Add the further effects of a case to the list of effects. A scene without further effects has
   !> no list.
   subroutine choose_contributions(case, equation)
      type(case_t), intent(in) :: case
      type(equation_t), intent(inout) :: equation
      type(contribution_t) :: effect
      logical, allocatable :: is_before(:), is_left(:)
      integer :: i

      do i = 1, effect_count
         call prepare_effect(i, case, equation, effect)
         if (effect%is_present) call append_contribution(equation, i, effect)
      end do
      if (equation%beam%n == 0) return
      ! Put the loops that act on the frame before that of the modes, which reads their force, and
      ! all others after it. Floors linked one by one belong to the loop of the modes.
      associate (scene => equation%scene)
         is_before = scene%terms%acts == through_link .or. scene%terms%acts == elsewhere
         is_left = is_before
         if (allocated(equation%beam%floors)) is_left = scene%terms%effect == bending_effect
         scene%bent = count(is_left)
         scene%terms = [pack(scene%terms, is_left), pack(scene%terms, .not. is_before)]
         if (allocated(equation%floors%k_link)) scene%terms(scene%bent)%floors &
            = equation%floors%first
      end associate
   end subroutine choose_contributions

   !> Append an effect. Its coefficients and states follow the existing ones.
   subroutine append_contribution(equation, number, effect)
      type(equation_t), intent(inout) :: equation
      integer, intent(in) :: number
      !! number of the effect in the list of all effects
      type(contribution_t), intent(in) :: effect
      real(wp), parameter :: slow = 1.0e-9_wp
      !! creep velocity in the time unit of the wall, over its slenderness [-]
      type(contribution_t), allocatable :: effects(:)
      integer :: n

      n = 0
      if (allocated(equation%effects)) n = size(equation%effects)
      allocate (effects(n + 1))
      if (n > 0) effects(:n) = equation%effects
      effects(n + 1) = effect
      call move_alloc(effects, equation%effects)
      associate (added => equation%effects(n + 1))
         if (effect%reads == 0) added%first = equation%scene%n + 1
         added%coef = equation%scene%n_coef + 1
         equation%state%ends_at_peak = equation%state%ends_at_peak .or. added%has_corner_at_turn
         if (added%has_corner_at_turn) equation%creep = slow*equation%p%alpha*sqrt( &
            equation%p%g_over_R)
      end associate
      if (.not. associated(effect%coefficients)) return
      call add_term(equation%scene, term_t(number, effect%n, effect%law, effect%n_coef, &
         effect%states, acts=effect%acts))
      if (effect%reads > 0) then
         associate (term => equation%scene%terms(size(equation%scene%terms)))
            term%state = effect%first
            term%n_states = effect%reads
         end associate
      end if
      ! kinematic effects run before the loops that read the kinematics
      if (effect%is_kinematic) equation%scene%terms = cshift(equation%scene%terms, -1)
   end subroutine append_contribution

   !> Expected magnitudes of all states, derived from the first two, for absolute tolerances.
   function state_sizes(equation, size_guess) result(sizes)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! sizes of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
      real(wp) :: sizes(equation%n)
      integer :: i

      sizes(:2) = size_guess
      if (equation%n == 2) return
      do i = 1, size(equation%effects)
         associate (extra => equation%effects(i))
            if (extra%states == 0) cycle
            call extra%sizes(extra, equation, size_guess, &
               sizes(extra%first:extra%first + extra%states - 1))
         end associate
      end do
   end function state_sizes

   !> Kinetic and strain energy of the frame, in addition to those of a single mass on an elastic
   !> spring [J/kg].
   function effects_frame_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: energy(2)
      integer :: i

      energy = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         if (associated(equation%effects(i)%frame_energy)) energy = energy &
            + equation%effects(i)%frame_energy(equation%effects(i), equation, y)
      end do
   end function effects_frame_energy

   !> Energy stored by the further effects [J/kg].
   real(wp) function effects_energy(equation, y) result(energy)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      integer :: i

      energy = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         if (associated(equation%effects(i)%energy)) then
            energy = energy + equation%effects(i)%energy(equation%effects(i), equation, y)
         end if
      end do
   end function effects_energy

   !> Forces with which further effects resist the displaced frame [m/s2]. The first acts against
   !> the links to the wall; the second is the total on floors with states.
   function effects_frame_force(equation, y) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: force(2)
      integer :: i

      force = 0
      if (.not. allocated(equation%effects)) return
      do i = 1, size(equation%effects)
         if (associated(equation%effects(i)%frame_force)) then
            force = force + equation%effects(i)%frame_force(equation%effects(i), equation, y)
         end if
      end do
   end function effects_frame_force

end module rwmf_model_system_contributions
