!> Common interface of all springs with memory: initial branch, force and energy of a branch, and
!> transitions between branches. Numbers are in the caller's units, see `spring_t`.
module rwmf_model_hysteresis_spring_laws
   use rwmf_core_kinds, only: wp
   use rwmf_model_bilinear_spring, only: bilinear_energy, bilinear_force, bilinear_limits, &
      bilinear_loss, bilinear_plastic, bilinear_residual, bilinear_word, draw_line, is_yielding, &
      pass_bilinear, turn_bilinear
   use rwmf_model_hysteresis_degrading, only: degrading_energy, degrading_loss, degrading_word, &
      pass_degrading, start_degrading, turn_degrading, unloaded_elongation
   use rwmf_model_hysteresis_flag, only: flag_energy, flag_loss, flag_word, pass_flag, &
      start_flag, turn_flag
   use rwmf_model_spring, only: branch_t, law_bilinear, law_degrading, law_flag, &
      line_force, spring_t
   use rwmf_problem_case, only: spring_law_t
   implicit none
   private

   public :: new_spring, new_branch, load_spring
   public :: spring_force, spring_plastic, spring_residual, spring_energy, spring_loss, forget_loss
   public :: spring_limits, pass_limit, turn_spring, loading_direction, has_wear
   public :: branch_word

contains

   !> Create the parameters of a spring.
   elemental type(spring_t) function new_spring(stiffness, yield, hardening, force_0, is_tendon, &
      rupture, law) result(spring)
      real(wp), intent(in) :: stiffness
      !! > 0
      real(wp), intent(in) :: yield
      !! > 0
      real(wp), intent(in) :: hardening
      !! stiffness after yielding over elastic stiffness, in (-1, 1)
      real(wp), intent(in), optional :: force_0
      !! force at x = 0, below `yield`; default 0
      logical, intent(in), optional :: is_tendon
      !! true if it bears tension only; default false
      real(wp), intent(in), optional :: rupture
      !! elongation at rupture; default none
      type(spring_law_t), intent(in), optional :: law
      !! law and its further parameters; default bilinear

      spring%stiffness = stiffness
      spring%yield = yield
      spring%hardening = hardening
      spring%modulus = hardening*stiffness/(1 - hardening)
      if (present(force_0)) spring%force_0 = force_0
      if (present(is_tendon)) spring%is_tendon = is_tendon
      if (present(rupture)) spring%rupture = rupture
      if (.not. present(law)) return
      spring%breakaway = law%breakaway
      spring%flag_height = law%flag_height
      select case (law%name)
      case ('flag')
         spring%law = law_flag
      case ('peak_oriented', 'pinched')
         spring%law = law_degrading
         associate (envelope => spring%backbone, u_y => yield/stiffness)
            envelope%cap = law%cap*u_y
            envelope%post_cap = law%post_cap*u_y
            envelope%residual = law%residual*yield
            where (law%lambda < huge(1.0_wp)) envelope%capacity = law%lambda*yield*u_y
            envelope%exponents = law%lambda_exponent
            envelope%is_pinched = law%name == 'pinched'
            envelope%pinch = [law%pinch_force, law%pinch_displacement]
         end associate
      case default
         spring%law = law_bilinear
      end select
   end function new_spring

   !> Initial branch of a spring.
   elemental type(branch_t) function new_branch(spring) result(branch)
      type(spring_t), intent(in) :: spring

      select case (spring%law)
      case (law_flag)
         call start_flag(spring, branch)
      case (law_degrading)
         call start_degrading(spring, branch)
      case default
         call draw_line(spring, branch)
      end select
   end function new_branch

   !> Load a spring at rest to the elongation x, as if it had grown slowly from zero, and begin to
   !> unload it.
   pure subroutine load_spring(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x
      real(wp) :: low, high

      do
         call spring_limits(spring, branch, low, high)
         if (x <= high .and. x >= low) exit
         call pass_limit(spring, branch, x > high)
      end do
      call turn_spring(spring, branch, x)
      call forget_loss(branch)
   end subroutine load_spring

   !> Force at the elongation x.
   elemental real(wp) function spring_force(spring, branch, x) result(force)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      if (spring%law == law_bilinear) then
         force = bilinear_force(spring, branch, x)
      else
         force = line_force(branch, x)
      end if
   end function spring_force

   !> Part of the elongation x by which the force lags behind an elastic one.
   elemental real(wp) function spring_plastic(spring, branch, x) result(plastic)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      if (spring%law == law_bilinear) then
         plastic = bilinear_plastic(spring, branch, x)
      else
         plastic = x - line_force(branch, x)/spring%stiffness
      end if
   end function spring_plastic

   !> Elongation of zero force after slow unloading from the elongation x, without prestress.
   elemental real(wp) function spring_residual(spring, branch, x) result(residual)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      select case (spring%law)
      case (law_flag)
         residual = 0
      case (law_degrading)
         residual = unloaded_elongation(spring, branch, x)
      case default
         residual = bilinear_residual(spring, bilinear_plastic(spring, branch, x))
      end select
   end function spring_residual

   !> Stored energy beyond that at x = 0 before any yielding.
   elemental real(wp) function spring_energy(spring, branch, x) result(energy)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      select case (spring%law)
      case (law_flag)
         energy = flag_energy(spring, branch, x)
      case (law_degrading)
         energy = degrading_energy(branch, x)
      case default
         energy = bilinear_energy(spring, branch, x)
      end select
   end function spring_energy

   !> Energy dissipated by the spring up to the elongation x, summed over all branches.
   elemental real(wp) function spring_loss(spring, branch, x) result(loss)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(in) :: x

      select case (spring%law)
      case (law_flag)
         loss = flag_loss(spring, branch, x)
      case (law_degrading)
         loss = degrading_loss(branch, x)
      case default
         loss = bilinear_loss(spring, branch, x)
      end select
   end function spring_loss

   !> Reset the dissipated energy to zero.
   elemental subroutine forget_loss(branch)
      type(branch_t), intent(inout) :: branch
      !! branch that does not yield

      branch%wear%counted = branch%wear%counted - branch%lost
      branch%lost = 0
   end subroutine forget_loss

   !> Elongations between which the active branch is valid.
   !>
   !> If yielding begins within round-off of a reversal, the spring could keep yielding while it
   !> unloads. So the branch also ends where x returns below the elongation at which it began.
   pure subroutine spring_limits(spring, branch, low, high)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      real(wp), intent(out) :: low
      !! -huge if there is no lower limit
      real(wp), intent(out) :: high
      !! huge if there is no upper limit

      if (spring%law == law_bilinear) then
         call bilinear_limits(spring, branch, low, high)
      else
         low = branch%low
         high = branch%high
      end if
   end subroutine spring_limits

   !> Begin the next branch where the elongation passes a limit of the active branch.
   pure subroutine pass_limit(spring, branch, is_rising)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      logical, intent(in) :: is_rising
      !! the elongation grows

      select case (spring%law)
      case (law_flag)
         call pass_flag(spring, branch, is_rising)
      case (law_degrading)
         call pass_degrading(spring, branch, is_rising)
      case default
         call pass_bilinear(spring, branch, is_rising)
      end select
   end subroutine pass_limit

   !> Reverse the motion at the elongation x: a yielding spring begins to unload.
   pure subroutine turn_spring(spring, branch, x)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(inout) :: branch
      real(wp), intent(in) :: x

      select case (spring%law)
      case (law_flag)
         call turn_flag(spring, branch, x)
      case (law_degrading)
         call turn_degrading(spring, branch, x)
      case default
         call turn_bilinear(spring, branch, x)
      end select
   end subroutine turn_spring

   !> Sign that the rate of the elongation keeps on the active branch; 0: either.
   elemental integer function loading_direction(spring, branch) result(direction)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch

      direction = branch%direction
      if (spring%law == law_bilinear) direction = merge(branch%kind, 0, is_yielding(branch))
   end function loading_direction

   !> Return whether a reversal changes the later response of the spring.
   elemental logical function has_wear(spring)
      type(spring_t), intent(in) :: spring

      has_wear = spring%law /= law_bilinear .or. spring%breakaway > 1
   end function has_wear

   !> Name of the active branch where it changes the stiffness of the envelope, else ''.
   !>
   !> The names are 'yield', 'slack', 'rupture', 'capping', 'residual' and 'failure'.
   pure function branch_word(spring, branch) result(word)
      type(spring_t), intent(in) :: spring
      type(branch_t), intent(in) :: branch
      character(8) :: word

      select case (spring%law)
      case (law_flag)
         word = flag_word(branch)
      case (law_degrading)
         word = degrading_word(branch)
      case default
         word = bilinear_word(branch)
      end select
   end function branch_word

end module rwmf_model_hysteresis_spring_laws
